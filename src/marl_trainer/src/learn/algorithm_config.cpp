#include "marl_trainer/learn/algorithm_config.hpp"

#include "auv_common/error.hpp"
#include "marl_trainer/learn/algorithms/happo/happo_config.hpp"
#include "marl_trainer/learn/algorithms/ippo/ippo_config.hpp"
#include "marl_trainer/learn/algorithms/maddpg/maddpg_config.hpp"
#include "marl_trainer/learn/algorithms/madqn/madqn_config.hpp"
#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"
#include "marl_trainer/learn/algorithms/masac/masac_config.hpp"
#include "marl_trainer/learn/algorithms/matd3/matd3_config.hpp"

namespace stg::learn {

void Algorithm::Join(Communicator*) {
  throw UserError("this algorithm learns in one process only");
}

void Algorithm::StartFrom(const Archive&) {
  throw UserError("this algorithm cannot start from the networks of another run");
}

void Algorithm::StartFrom(const agent::Policy&) {
  throw UserError("this algorithm cannot start from a policy file");
}

void AlgorithmConfig::ApplyPreset(const std::string& preset, TrainConfig*) {
  if (preset != "fast") throw UserError("--preset: '" + preset + "' is not fast");
}

void AlgorithmConfig::ValidateOrThrow(const TrainConfig&) const {}

void AlgorithmConfig::ApplyRecordings(const TrainConfig&) {
  throw UserError("this algorithm does not learn from recordings");
}

void AlgorithmConfig::FitPolicy(const agent::Policy&) {
  throw UserError("this algorithm cannot start from a policy file");
}

AlgorithmRegistry& Algorithms() {
  static AlgorithmRegistry registry("algorithm", {
                                                     {"mappo", std::make_unique<MappoConfig>},
                                                     {"ippo", std::make_unique<IppoConfig>},
                                                     {"happo", std::make_unique<HappoConfig>},
                                                     {"maddpg", std::make_unique<MaddpgConfig>},
                                                     {"matd3", std::make_unique<Matd3Config>},
                                                     {"masac", std::make_unique<MasacConfig>},
                                                     {"madqn", std::make_unique<MadqnConfig>},
                                                 });
  return registry;
}

std::string DefaultAlgorithm() { return Algorithms().Names().front(); }

}  // namespace stg::learn

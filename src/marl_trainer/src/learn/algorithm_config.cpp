#include "marl_trainer/learn/algorithm_config.hpp"

#include <algorithm>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/algorithms/happo/happo_config.hpp"
#include "marl_trainer/learn/algorithms/ippo/ippo_config.hpp"
#include "marl_trainer/learn/algorithms/maddpg/maddpg_config.hpp"
#include "marl_trainer/learn/algorithms/madqn/madqn_config.hpp"
#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"
#include "marl_trainer/learn/algorithms/masac/masac_config.hpp"
#include "marl_trainer/learn/algorithms/matd3/matd3_config.hpp"

namespace stg::learn {

std::vector<Shard> ShardsOf(const GroupShare& share, int first, int count, int envs) {
  std::vector<Shard> shards;
  for (int group = first; group < first + count; ++group) {
    const int end = share.FirstEnv(group + 1, envs);
    for (int env = share.FirstEnv(group, envs); env < end;) {
      Shard shard;
      shard.first_env = env;
      shard.envs = std::min((env / Shard::kEnvs + 1) * Shard::kEnvs, end) - env;
      shard.group = group;
      shards.push_back(shard);
      env += shard.envs;
    }
  }
  return shards;
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

#include "marl_trainer/learn/algorithms/maddpg/maddpg_config.hpp"

#include "marl_trainer/learn/algorithms/maddpg/maddpg.hpp"

namespace stg::learn {

std::unique_ptr<AlgorithmConfig> MaddpgConfig::Clone() const {
  return std::make_unique<MaddpgConfig>(*this);
}

void MaddpgConfig::Describe(OptionTable* t) {
  ReplayConfig::Describe(t);
  DescribeCritics(t);
  t->Add("noise-min", &noise_min, {0, 10},
         "exploration noise of the first environment, in shares of the action's scale; between it "
         "and the last one it grows by equal factors");
  t->Add("noise-max", &noise_max, {0, 10}, "exploration noise of the last environment");
  t->Add("others", &others,
         "actions of the other AUVs in the actor's loss: buffer (as they were, Lowe et al.) or "
         "policy (as they would be now)");
}

void MaddpgConfig::ApplyPreset(const std::string& preset, TrainConfig* common) {
  ReplayConfig::ApplyPreset(preset, common);
  if (preset == "paper") noise_min = noise_max = 0.1;
}

void MaddpgConfig::ValidateOrThrow(const TrainConfig& common) const {
  ReplayConfig::ValidateOrThrow(common);
  RequireOption(others == "buffer" || others == "policy", "others",
                "'" + others + "' is not buffer or policy");
  RequireOption(noise_min <= noise_max, "noise-max", "is below --noise-min");
  RequireOption(noise_min > 0.0 || noise_max == 0.0, "noise-min",
                "must not be 0 where --noise-max is not");
}

std::unique_ptr<Algorithm> MaddpgConfig::Make(const TrainConfig& common, const Problem& problem,
                                              WorkerPool* pool) const {
  return std::make_unique<Maddpg>(*this, *this, common, problem, pool);
}

}  // namespace stg::learn

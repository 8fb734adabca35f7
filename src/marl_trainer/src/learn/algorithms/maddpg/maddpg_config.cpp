#include "marl_trainer/learn/algorithms/maddpg/maddpg_config.hpp"

#include "marl_trainer/learn/algorithms/maddpg/maddpg.hpp"

namespace stg::learn {

void MaddpgConfig::Describe(config::Table* t) {
  ReplayConfig::Describe(t);
  DescribeCritics(t);
  noise.Describe("noise", 10.0, "exploration noise, as a share of the action's scale,", t);
  t->Add("others", config::Enum(&others, {"buffer", "policy"}), config::kNone, "-",
         "actions of the other AUVs in the actor's loss: buffer (the recorded actions, Lowe et "
         "al.) or policy (those of the present policy)");
}

void MaddpgConfig::ApplyPreset(const std::string& preset, TrainConfig* common) {
  ReplayConfig::ApplyPreset(preset, common);
  if (preset != "paper") return;
  noise = {0.1, 0.1};
  others = OthersAct::kThen;
}

void MaddpgConfig::ValidateOrThrow(const TrainConfig& common) const {
  ReplayConfig::ValidateOrThrow(common);
  noise.ValidateOrThrow("noise");
}

std::unique_ptr<Algorithm> MaddpgConfig::Make(const TrainConfig& common, const Problem& problem,
                                              const Team& team) const {
  return std::make_unique<Maddpg>(*this, *this, common, problem, team);
}

}  // namespace stg::learn

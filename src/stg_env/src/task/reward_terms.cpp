#include "stg_env/task/reward_term.hpp"

namespace stg::task {

RewardTermRegistry& RewardTermsByName() {
  static RewardTermRegistry registry("reward term",
                                     {
                                         STG_ENTRY(RewardTermRegistry, EffortTermEntry),
                                         STG_ENTRY(RewardTermRegistry, EnergyTermEntry),
                                         STG_ENTRY(RewardTermRegistry, EstimateTermEntry),
                                         STG_ENTRY(RewardTermRegistry, ObstacleTermEntry),
                                         STG_ENTRY(RewardTermRegistry, SeabedTermEntry),
                                         STG_ENTRY(RewardTermRegistry, SpreadTermEntry),
                                     });
  return registry;
}

std::vector<std::string> TermsOfOpenWater() { return {"estimate", "obstacle", "seabed"}; }

}  // namespace stg::task

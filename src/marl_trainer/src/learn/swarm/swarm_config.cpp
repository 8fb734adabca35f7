#include "marl_trainer/learn/swarm/swarm_config.hpp"

namespace stg::learn {
namespace {

/// Conditions of the mixture, by how often they come.
constexpr const char* kConditions[] = {
    "nominal",        "combined_stress",       "fast_target",     "combined_stress",
    "nominal",        "limited_sensing",       "combined_stress", "far_initialization",
    "strong_current", "degraded_communication"};
constexpr int kConditionCount = static_cast<int>(sizeof(kConditions) / sizeof(kConditions[0]));
constexpr int kSizes[] = {4, 3, 6, 4, 8, 5, 4, 7};
constexpr int kSizeCount = static_cast<int>(sizeof(kSizes) / sizeof(kSizes[0]));

}  // namespace

std::vector<SwarmTask> FieldMixture(const std::string& folder, const std::string& scenario,
                                    const SwarmConfig& config, int count) {
  std::vector<SwarmTask> mixture;
  for (int k = 0; k < count; ++k) {
    const char* condition = kConditions[k % kConditionCount];
    const int agents = kSizes[k % kSizeCount];
    const std::string steps = std::to_string(config.episode_steps);
    const std::vector<std::string> overrides = {
        "agents=" + std::to_string(agents),
        "time.episode_steps=" + steps,
        "time.tail_steps=" + steps,
        // What is near the band pays; the way to it is in the shaping.
        "reward.error_max_m=40.0",
        "reward.w_band=1.0",
        "reward.w_progress=0.0",
        "reward.w_closing=0.0",
        "reward.w_reacquire=0.0",
        "reward.w_too_close=2.0",
        "reward.weights.semantic=0.3",
        "reward.weights.control_cost=0.0",
        "reward.weights.separation=1.5",
        "reward.separation_distance_m=40.0",
        "reward.terms.estimate.weight=0.2",
        "reward.terms.spread.weight=0.5",
        "reward.total_limit=10.0",
    };
    mixture.push_back({std::string(condition) + "/" + std::to_string(agents),
                       LoadNamedScenario(folder, scenario, condition, overrides)});
  }
  return mixture;
}

std::vector<SwarmTask> FieldValidation(const std::string& folder, const std::string& scenario) {
  std::vector<SwarmTask> tasks;
  for (const char* condition : {"nominal", "combined_stress", "fast_target"}) {
    tasks.push_back({condition, LoadNamedScenario(folder, scenario, condition)});
  }
  return tasks;
}

}  // namespace stg::learn

#include "marl_trainer/learn/swarm/swarm_config.hpp"

/// The scenarios that a training between walls flies.
namespace stg::learn {
namespace {

/// A kind of a mixture between walls.
struct Basin {
  const char* condition;
  int agents;
};
constexpr Basin kBasins[] = {
    {"nominal", 4},
    {"degraded_communication", 4},
    {"combined_stress", 4},
    {"fast_target", 4},
    {"degraded_communication", 4},
    {"combined_stress", 4},
    {"far_initialization", 4},
    {"nominal", 4},
    {"limited_sensing", 4},
    {"limited_sensing", 4},
    {"degraded_communication", 4},
    {"combined_stress", 4},
    {"combined_stress", 2},
    {"degraded_communication", 4},
    {"degraded_communication", 8},
    {"combined_stress", 6},
};
constexpr int kBasinsCount = static_cast<int>(sizeof(kBasins) / sizeof(kBasins[0]));
/// AUVs closer than this share of their diameter cost reward.
constexpr double kSeparation = 1.06;

}  // namespace

std::vector<SwarmTask> WallsMixture(const std::string& folder,
                                    const std::vector<std::string>& scenarios,
                                    const SwarmConfig& config, int count,
                                    const std::vector<std::string>& overrides) {
  config.ValidateOrThrow();
  std::vector<SwarmTask> mixture;
  for (int k = 0; k < count; ++k) {
    const std::string& name = scenarios[static_cast<std::size_t>(k) % scenarios.size()];
    const Basin& basin = kBasins[k % kBasinsCount];
    const agent::AgentModel model = LoadNamedScenario(folder, name, basin.condition).model();
    agent::RequireFits(config.action, model);
    const std::string steps = std::to_string(config.episode_steps);
    const double apart_m = kSeparation * 2.0 * model.vehicle.radius_m;
    std::vector<std::string> keys = NotSetBy(
        overrides, {"agents=" + std::to_string(basin.agents), "time.episode_steps=" + steps,
                    "time.tail_steps=" + steps, "reward.weights.separation=0.2",
                    "reward.separation_distance_m=" + std::to_string(apart_m)});
    keys.insert(keys.end(), overrides.begin(), overrides.end());
    mixture.push_back({name + "/" + basin.condition + "/" + std::to_string(basin.agents),
                       LoadNamedScenario(folder, name, basin.condition, keys)});
  }
  return mixture;
}

std::vector<SwarmTask> WallsValidation(const std::string& folder,
                                       const std::vector<std::string>& scenarios,
                                       const std::vector<std::string>& overrides) {
  std::vector<SwarmTask> tasks;
  for (const std::string& name : scenarios) {
    for (const char* condition : {"nominal", "combined_stress"}) {
      tasks.push_back(
          {name + "/" + condition, LoadNamedScenario(folder, name, condition, overrides)});
    }
  }
  return tasks;
}

}  // namespace stg::learn

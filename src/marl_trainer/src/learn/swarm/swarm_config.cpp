#include "marl_trainer/learn/swarm/swarm_config.hpp"

#include "auv_common/error.hpp"

namespace stg::learn {
namespace {

struct Waters {
  const char* scenario;  ///< null: the one that is trained for
  const char* condition;
  int agents;
  int targets = 1;
  int longer = 1;  ///< episodes by this: a search takes long before anything pays
};

/// The kinds of waters of the mixture, in the order in which they come.
constexpr Waters kWaters[] = {
    {nullptr, "combined_stress", 4},
    {"search", "nominal", 4, 1, 2},
    {"hunt", "nominal", 4},
    {nullptr, "nominal", 8},
    {nullptr, "fast_target", 6},
    {nullptr, "strong_current", 3},
    {nullptr, "sparse", 4},
    {nullptr, "nominal", 4},
    {nullptr, "combined_stress", 6},
    {"search", "nominal", 6, 1, 2},
    {nullptr, "nominal", 6, 2},
    {nullptr, "limited_sensing", 5},
    {"hunt", "nominal", 8},
    {nullptr, "degraded_communication", 7},
    {nullptr, "far_initialization", 1},
    {nullptr, "combined_stress", 2},
};
/// With free_assignment these take the place of others: {place above, waters}.
constexpr std::pair<int, Waters> kFreeWaters[] = {
    {3, {"many8", "nominal", 8, 2}},
    {7, {"many8", "nominal", 4, 2}},
    {10, {"many8", "nominal", 6, 2}},
    {12, {"many8", "nominal", 5, 2}},
};
constexpr int kWatersCount = static_cast<int>(sizeof(kWaters) / sizeof(kWaters[0]));

Waters WatersAt(int place, bool free_assignment) {
  for (const auto& [replaced, waters] : kFreeWaters) {
    if (free_assignment && replaced == place) return waters;
  }
  return kWaters[place];
}

}  // namespace

std::vector<SwarmTask> FieldMixture(const std::string& folder, const std::string& scenario,
                                    const SwarmConfig& config, int count) {
  if (config.free_assignment && config.network != agent::EntityNetwork::kGraph) {
    throw UserError(std::string("--free-assignment: the network '") +
                    agent::EntityNetworkName(config.network) +
                    "' does not choose a target; --network graph does");
  }
  std::vector<SwarmTask> mixture;
  for (int k = 0; k < count; ++k) {
    const Waters waters = WatersAt(k % kWatersCount, config.free_assignment);
    const std::string steps = std::to_string(config.episode_steps * waters.longer);
    const std::string name = waters.scenario != nullptr ? waters.scenario : scenario;
    const std::vector<std::string> overrides = {
        "agents=" + std::to_string(waters.agents),
        "target.count=" + std::to_string(waters.targets),
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
    mixture.push_back({name + "/" + waters.condition + "/" + std::to_string(waters.agents),
                       LoadNamedScenario(folder, name, waters.condition, overrides)});
  }
  return mixture;
}

std::vector<SwarmTask> FieldValidation(const std::string& folder, const std::string& scenario) {
  std::vector<SwarmTask> tasks;
  for (const char* condition : {"nominal", "combined_stress", "fast_target", "strong_current"}) {
    tasks.push_back({condition, LoadNamedScenario(folder, scenario, condition)});
  }
  for (const char* name : {"hunt", "search"}) {
    tasks.push_back({name, LoadNamedScenario(folder, name, "nominal")});
  }
  return tasks;
}

}  // namespace stg::learn

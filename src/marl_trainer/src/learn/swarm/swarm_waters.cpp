#include <algorithm>
#include <sstream>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/options.hpp"
#include "marl_trainer/learn/swarm/swarm_config.hpp"
#include "marl_trainer/learn/swarm/swarm_reward.hpp"

namespace stg::learn {
namespace {

constexpr int kOwn = 0;  ///< the scenario's own number

struct Waters {
  std::string scenario;  ///< empty: the scenario of the training
  std::string condition = "nominal";
  int agents = kOwn;
  int targets = kOwn;
  /// Factor of the episode's length, because a search gets a reward only after a long time.
  int longer = 1;
};

/// The scenarios of the mixture, in their order.
const std::vector<Waters>& Mixture() {
  static const std::vector<Waters> mixture = {
      {"", "combined_stress", 4, 1},
      {"search", "nominal", 4, 1, 2},
      {"hunt", "nominal", 4, 1},
      {"", "nominal", 8, 1},
      {"", "fast_target", 6, 1},
      {"", "strong_current", 3, 1},
      {"", "sparse", 4, 1},
      {"", "nominal", 4, 1},
      {"", "combined_stress", 6, 1},
      {"search_evasive", "nominal", 4, 1, 2},
      {"", "nominal", 6, 2},
      {"", "limited_sensing", 5, 1},
      {"hunt", "nominal", 8, 1},
      {"", "degraded_communication", 7, 1},
      {"", "far_initialization", 1, 1},
      {"", "sparse", 2, 1},
  };
  return mixture;
}

/// With free_assignment these replace others: {place above, waters}.
const std::vector<std::pair<int, Waters>>& FreeWaters() {
  static const std::vector<std::pair<int, Waters>> waters = {
      {3, {"many8", "nominal", 8, 2}},
      {7, {"many8", "nominal", 4, 2}},
      {10, {"many8", "nominal", 6, 2}},
      {12, {"many8", "nominal", 5, 2}},
  };
  return waters;
}

std::vector<std::string> Split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

int CountOf(const std::string& text, const std::string& kind, const char* what) {
  const bool digits = !text.empty() && text.size() <= 3 &&
                      text.find_first_not_of("0123456789") == std::string::npos;
  const int count = digits ? std::stoi(text) : 0;
  RequireOption(count > 0, "waters",
                "'" + kind + "': the number of " + what + " is '" + text + "', not 1 or more");
  return count;
}

Waters ReadWaters(const std::string& kind) {
  const std::vector<std::string> parts = Split(kind, ':');
  RequireOption(!parts.empty() && !parts[0].empty() && parts.size() <= 4, "waters",
                "'" + kind + "' is not name:condition:AUVs:targets");
  Waters waters;
  waters.scenario = parts[0];
  if (parts.size() > 1 && !parts[1].empty()) waters.condition = parts[1];
  if (parts.size() > 2) waters.agents = CountOf(parts[2], kind, "AUVs");
  if (parts.size() > 3) waters.targets = CountOf(parts[3], kind, "targets");
  return waters;
}

/// What a training with these options flies, in the order of the places.
std::vector<Waters> KindsOf(const SwarmConfig& config) {
  if (!config.waters.empty()) {
    RequireOption(!config.free_assignment, "free-assignment",
                  "has no effect with --waters; scenarios such as many8 let AUVs choose");
    std::vector<Waters> kinds;
    for (const std::string& kind : Split(config.waters, ',')) kinds.push_back(ReadWaters(kind));
    return kinds;
  }
  std::vector<Waters> kinds = Mixture();
  if (config.free_assignment) {
    for (const auto& [place, waters] : FreeWaters()) {
      kinds[static_cast<std::size_t>(place)] = waters;
    }
  }
  return kinds;
}

std::vector<std::string> SwarmKeys(const Waters& waters) {
  std::vector<std::string> keys;
  if (waters.agents != kOwn) keys.push_back("agents=" + std::to_string(waters.agents));
  if (waters.targets != kOwn) keys.push_back("target.count=" + std::to_string(waters.targets));
  return keys;
}

std::string NameOf(const Waters& waters, const std::string& scenario) {
  return waters.scenario.empty() ? scenario : waters.scenario;
}

}  // namespace

std::vector<std::string> NotSetBy(const std::vector<std::string>& others,
                                  const std::vector<std::string>& overrides) {
  std::vector<std::string> left;
  for (const std::string& override : overrides) {
    const std::string start = override.substr(0, override.find('=') + 1);
    const bool set = std::any_of(others.begin(), others.end(), [&](const std::string& other) {
      return other.rfind(start, 0) == 0;
    });
    if (!set) left.push_back(override);
  }
  return left;
}

std::vector<SwarmTask> FieldMixture(const std::string& folder, const std::string& scenario,
                                    const SwarmConfig& config, int count,
                                    const std::vector<std::string>& overrides) {
  config.ValidateOrThrow();
  const std::vector<Waters> kinds = KindsOf(config);
  RequireOption(!config.free_assignment || count > FreeWaters()[0].first, "free-assignment",
                "needs --envs 32 or more, because fewer have no waters with several targets");
  RequireOption(config.waters.empty() || count >= static_cast<int>(kinds.size()), "waters",
                std::to_string(kinds.size()) + " kinds need --envs " +
                    std::to_string(8 * kinds.size()) + " or more, eight for each");
  std::vector<SwarmTask> mixture;
  for (int k = 0; k < count; ++k) {
    const Waters& waters = kinds[static_cast<std::size_t>(k) % kinds.size()];
    const std::string steps = std::to_string(config.episode_steps * waters.longer);
    const std::string name = NameOf(waters, scenario);
    std::vector<std::string> keys = SwarmKeys(waters);
    keys.push_back("time.episode_steps=" + steps);
    keys.push_back("time.tail_steps=" + steps);
    const int agents =
        LoadNamedScenario(folder, name, waters.condition, SwarmKeys(waters)).run.agents;
    if (config.leaving && k % 4 == 3) {
      const std::string leave = "[" + std::to_string(config.episode_steps / 3);
      const std::string join = "[" + std::to_string(2 * config.episode_steps / 3);
      const std::string second = agents >= 5 ? ", " + leave + ", 1]" : "";
      keys.push_back("fleet.leave=[" + leave + ", 0]" + second + "]");
      keys.push_back("fleet.join=[" + join + ", 0]]");
    }
    const std::vector<std::string> reward = NotSetBy(overrides, SwarmRewardKeys());
    keys.insert(keys.end(), reward.begin(), reward.end());
    keys.insert(keys.end(), overrides.begin(), overrides.end());
    mixture.push_back({name + "/" + waters.condition + "/" + std::to_string(agents),
                       LoadNamedScenario(folder, name, waters.condition, keys)});
  }
  return mixture;
}

std::vector<SwarmTask> FieldValidation(const std::string& folder, const std::string& scenario,
                                       const SwarmConfig& config,
                                       const std::vector<std::string>& overrides) {
  std::vector<SwarmTask> tasks;
  const auto add = [&](const std::string& label, const Waters& waters) {
    std::vector<std::string> keys = SwarmKeys(waters);
    keys.insert(keys.end(), overrides.begin(), overrides.end());
    tasks.push_back(
        {label, LoadNamedScenario(folder, NameOf(waters, scenario), waters.condition, keys)});
  };
  if (!config.waters.empty()) {
    for (const std::string& kind : Split(config.waters, ',')) add(kind, ReadWaters(kind));
    return tasks;
  }
  for (const char* condition :
       {"nominal", "combined_stress", "fast_target", "strong_current", "sparse"}) {
    add(condition, {"", condition});
  }
  for (const char* name : {"hunt", "search", "search_evasive"}) add(name, {name});
  return tasks;
}

}  // namespace stg::learn

#pragma once

#include <string>
#include <vector>

#include "auv_common/config/files.hpp"
#include "auv_common/numbers/random.hpp"
#include "marl_trainer/env/env.hpp"
#include "marl_trainer/scenario/scenario.hpp"

/// What the tests of the environment share.
namespace stg::env {

inline Scenario Shipped(const std::string& name, const std::string& condition = "nominal",
                        const std::vector<std::string>& overrides = {}) {
  return LoadNamedScenario(STG_SCENARIO_FOLDER, name, condition, overrides);
}

/// The scenario with episodes of `steps` decisions.
inline Scenario Short(Scenario s, int steps) {
  s.time.episode_steps = steps;
  s.time.tail_steps = std::min(s.time.tail_steps, steps);
  return s;
}

/// A different random action for every AUV, decision and global reset r = first_env + lane +
/// round * total_envs, whatever lane, group or worker runs it. [kLanes, agents, action_size].
inline std::vector<float> ActionsOf(const EnvGroup& env, const EnvOptions& o) {
  std::vector<float> actions;
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::uint64_t r = static_cast<std::uint64_t>(o.first_env + lane) +
                            env.round() * static_cast<std::uint64_t>(o.total_envs);
    for (int i = 0; i < env.agents(); ++i) {
      Random random(77 + r, Stream::kPolicy, 0, static_cast<std::uint32_t>(env.step()),
                    static_cast<std::uint32_t>(i));
      for (int k = 0; k < env.action_size(); ++k) {
        actions.push_back(static_cast<float>(random.Uniform(-1.0, 1.0)));
      }
    }
  }
  return actions;
}

/// Zero for everybody: AUVs at rest stay where they are.
inline std::vector<float> Idle(const EnvGroup& env) {
  return std::vector<float>(static_cast<size_t>(kLanes * env.agents() * env.action_size()), 0.0F);
}

inline std::vector<float> Observations(const EnvGroup& env) {
  return {env.observations(), env.observations() + kLanes * env.agents() * env.observation_size()};
}
inline std::vector<float> States(const EnvGroup& env) {
  return {env.states(), env.states() + kLanes * env.state_size()};
}
inline const float* Row(const EnvGroup& env, int lane, int i) {
  return env.observations() +
         static_cast<size_t>(lane * env.agents() + i) * static_cast<size_t>(env.observation_size());
}

/// First index of each block of the observation (docs/environment.md).
enum ObservationIndex {
  kOwnPosition = 0,
  kTargetOffset = 15,
  kNeighbours = 18,
  kTargetVelocity = 30,
  kPreviousTau = 45,
  kTracking = 51,
  kShownConfidence = kTracking + 5,
  kSemantic = 59,
  kGraph = 68,
};

}  // namespace stg::env

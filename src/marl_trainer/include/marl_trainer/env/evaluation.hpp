#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "marl_trainer/env/env.hpp"
#include "stg_agent/controllers/controller.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::env {

/// Who flies in an evaluation: a policy file or a built-in controller.
struct Controller {
  std::string name;
  std::shared_ptr<const agent::Policy> policy;       ///< null: built-in
  std::shared_ptr<const agent::Controller> builtin;  ///< null: policy
  bool privileged = false;  ///< a built-in controller reads true states in acoustic mode, too
};

/// A built-in controller (see agent::MakeController), or the path of an ONNX file, which
/// must fit the scenario. Throws UserError.
Controller MakeController(const std::string& name_or_file, const Scenario& scenario);

/// Deterministic actions of every AUV of every lane, [kLanes, agents, action_size].
/// In truth mode a built-in controller reads true states, in acoustic mode each
/// agent's own estimates unless it is privileged.
void Decide(const Controller& controller, const EnvGroup& env, double* actions);

/// Runs `episodes` episodes, episode e from world seed `seed` + e, on `workers`
/// threads. The result does not depend on the number of workers.
/// @param progress called with the number of finished episodes; may be empty.
std::vector<task::EpisodeMetrics> Evaluate(const Scenario& scenario, const Controller& controller,
                                           int episodes, std::uint64_t seed, int workers,
                                           const std::function<void(int)>& progress = {});

}  // namespace stg::env

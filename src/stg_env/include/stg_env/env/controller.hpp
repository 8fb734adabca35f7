#pragma once

#include <memory>
#include <string>
#include <vector>

#include "stg_agent/controllers/controller.hpp"
#include "stg_agent/entities/entity_policy.hpp"
#include "stg_agent/policy/policy.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::env {

/// Who flies: a policy file or a built-in controller.
struct Controller {
  std::string name;
  /// One for all AUVs or one for each; empty: built-in.
  std::vector<std::shared_ptr<const agent::Policy>> policies;
  std::shared_ptr<const agent::Controller> builtin;  ///< null: policies or entities
  /// One for all AUVs, of any number, that decides on entities; acoustic mode only.
  std::shared_ptr<const agent::EntityPolicy> entities;
  bool privileged = false;  ///< a built-in controller reads true states in acoustic mode, too
};

/// A built-in controller (see agent::MakeController), or the path of an ONNX file, or of one for
/// each AUV (see agent::PolicyFileOf), which must fit the scenario. Throws UserError.
Controller MakeController(const std::string& name_or_file, const agent::AgentModel& model);

/// Deterministic actions of every AUV of every environment, [envs, agents, action_size]. In truth
/// mode a built-in controller reads true states, in acoustic mode each agent's own estimates unless
/// it is privileged.
/// @param observations [envs, agents, observation_size], as `env` wrote them
void Decide(const Controller& controller, const VectorEnv& env, const float* observations,
            double* actions);

}  // namespace stg::env

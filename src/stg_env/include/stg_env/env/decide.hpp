#pragma once

#include "stg_agent/decider/decider.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::env {

/// Deterministic actions of every AUV of every environment, [envs, agents, action_size]. A built-in
/// controller reads true states in truth mode. In acoustic mode it reads each agent's own
/// estimates, unless it is privileged.
/// @param observations [envs, agents, observation_size], as `env` wrote them
/// Throws UserError for a policy over entities in truth mode.
void Decide(const agent::Decider& decider, const VectorEnv& env, const float* observations,
            double* actions);

/// Lets a built-in controller read true states, also in acoustic mode. Throws UserError if this has
/// no effect: for a policy, for `idle`, and in truth mode.
void ReadTruth(agent::Decider* decider, InformationMode mode);

}  // namespace stg::env

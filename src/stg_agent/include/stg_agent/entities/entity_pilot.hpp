#pragma once

#include "stg_agent/controllers/encircle.hpp"
#include "stg_agent/entities/entity_policy.hpp"

namespace stg::agent {

/// A command lasts this long: nothing new arrives in between, because the range sensor looks every
/// 5 s.
inline constexpr double kCommandPeriod_s = 5.0;

/// What a `guidance` command says to the law: +-60 m of radius, outwards with three deviations of
/// the estimate more (800 m at most), so that a lost target is searched for on circles as wide as
/// the doubt; +-0.8 m/s, +-60 deg of phase, clockwise from -0.8 down, +-15 m of depth.
/// @param doubt_m deviation of the target's estimate along the long axis of its ellipse
Guidance<double> GuidanceOf(const float* command, double doubt_m);

/// Whether the AUV needs a new command at this decision.
bool CommandDue(const EntityMemory& memory);
/// Takes a command for the time to come.
/// @param command [CommandSize], clipped to [-1, 1]
void TakeCommand(const AgentView& agent, EntityAction action, const float* command);
/// Takes what a policy has chosen for the same time: the row of a target, which the AUV follows
/// from the next decision on, or their number: to search, where it keeps a map.
void TakeChoice(const AgentView& agent, const Entities& entities, int choice);
/// The scenario's action that follows the last command now, rounded to float; every decision.
/// @param out [action_size]
void FollowCommand(const AgentView& agent, EntityAction action, float* out);

/// The deterministic policy: a new command where one is due, then the action.
void Fly(const EntityPolicy& policy, const AgentView& agent, float* out);

}  // namespace stg::agent

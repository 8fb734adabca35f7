#pragma once

#include "stg_agent/controllers/encircle.hpp"
#include "stg_agent/entities/entity_policy.hpp"

namespace stg::agent {

/// A command lasts this long, or one decision if that is longer: nothing new arrives in between,
/// because the range sensor of the field looks every 5 s. A `velocity3` command lasts one decision.
inline constexpr double kCommandPeriod_s = 5.0;
/// Number of decisions during a command in open water, at least 1.
int DecisionsPerCommand(const RunConfig& run);
/// The same of any action.
int DecisionsPerCommand(const RunConfig& run, EntityAction action);
/// Time between two commands of a scenario in open water [s].
double CommandPeriod_s(const RunConfig& run);
/// The same of any action.
double CommandPeriod_s(const RunConfig& run, EntityAction action);

/// Guidance of a `guidance` command: +-60 m of radius; +-0.8 m/s; +-60 deg of phase; clockwise from
/// -0.8 down; +-15 m of depth. A larger radius grows by three more standard deviations of the
/// estimate (at most 800 m), so a lost target is searched on circles as wide as the uncertainty.
/// @param doubt_m deviation of the target's estimate along the long axis of its ellipse
Guidance<double> GuidanceOf(const float* command, double doubt_m);

/// True if the AUV needs a new command at this decision.
bool CommandDue(const EntityMemory& memory, EntityAction action);
/// The command of `velocity3` for a velocity in world axes, as a share of the largest velocity.
/// @param velocity [3], as a controller of interface velocity3 acts
/// @param command [3], clipped to what the network reaches
void VelocityCommandOf(const AgentView& agent, const double* velocity, float* command);
/// Stores a command for the next decisions.
/// @param command [CommandSize], clipped to [-1, 1]
void TakeCommand(const AgentView& agent, EntityAction action, const float* command);
/// Stores a policy's choice for the same time: the row of a target, which the AUV follows from the
/// next decision on; or the number of rows, which means to search if there is a map.
void TakeChoice(const AgentView& agent, const Entities& entities, int choice);
/// Stores a command and the choice that belongs to it. For a policy that does not choose (network
/// `pool`), the law `assign` chooses the target where an AUV may choose one.
void TakeDecision(const AgentView& agent, const Entities& entities, EntityAction action,
                  bool chooses, int choice, const float* command);
/// The scenario's action at this decision for the last command, rounded to float.
/// @param out [action_size]
void FollowCommand(const AgentView& agent, EntityAction action, float* out);

/// The deterministic policy: makes a new command if one is due, then the action.
void Fly(const EntityPolicy& policy, const AgentView& agent, float* out);

}  // namespace stg::agent

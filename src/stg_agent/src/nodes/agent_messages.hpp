#pragma once

#include <auv_msgs/TaskState.h>

#include "stg_agent/agent/agent.hpp"

namespace stg::nodes {

/// Writes an agent's knowledge and action after Observe and Act. The caller sets header, episode
/// and step.
void SetTaskState(const agent::Agent& agent, const agent::AgentOutput& output,
                  auv_msgs::TaskState* message);

}  // namespace stg::nodes

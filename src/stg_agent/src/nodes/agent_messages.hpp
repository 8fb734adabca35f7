#pragma once

#include <auv_msgs/TaskState.h>

#include "stg_agent/agent/agent.hpp"

namespace stg::nodes {

/// What an agent knows and does after Observe and Act. Header, episode and step are the caller's.
void SetTaskState(const agent::Agent& agent, const agent::AgentOutput& output,
                  auv_msgs::TaskState* message);

}  // namespace stg::nodes

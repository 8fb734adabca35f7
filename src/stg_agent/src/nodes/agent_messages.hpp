#pragma once

#include <auv_msgs/TaskState.h>

#include "stg_agent/agent/agent.hpp"

namespace stg {

/// What an agent knows and does after Observe and Act. Header, episode and step are the caller's.
void SetTaskState(const Agent& agent, const AgentOutput& output, auv_msgs::TaskState* message);

}  // namespace stg

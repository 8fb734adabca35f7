#pragma once

/// Names of the agent's topics and services.
namespace stg::topics {

// Of each AUV, below Auv(i).
inline constexpr char kTaskState[] = "task_state";
inline constexpr char kAgentStep[] = "agent_step";
inline constexpr char kLoadPolicy[] = "load_policy";  ///< below the agent node's own name

}  // namespace stg::topics

#pragma once

#include <string>

/// Names of the agent's topics and services.
namespace stg::topics {

// Of each AUV, below Auv(i).
inline constexpr char kTaskState[] = "task_state";
inline constexpr char kAgentStep[] = "agent_step";
inline constexpr char kEntityStep[] = "entity_step";
inline constexpr char kSearchMap[] = "search_map";
inline constexpr char kLoadPolicy[] = "load_policy";  ///< below the agent node's own name

/// Of each beacon and surface craft.
inline std::string StationOdom(int k) { return "/station_" + std::to_string(k) + "/odom"; }

}  // namespace stg::topics

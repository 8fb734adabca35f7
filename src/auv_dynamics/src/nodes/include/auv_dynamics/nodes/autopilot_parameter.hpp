#pragma once

#include "auv_common/error.hpp"
#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {

/// The private parameter `autopilot` of agents and world: what turns a desired velocity into what
/// moves the vehicle. False, `external`: a controller node. True, `onboard`: of vehicles that force
/// and moment command, the agent; of those that an autopilot steers, the world, as its own loop
/// runs inside a real vehicle. Throws UserError for anything else.
inline bool AutopilotOnBoardParameter() {
  const std::string autopilot = TextParameter("autopilot", "external");
  if (autopilot == "onboard") return true;
  if (autopilot == "external") return false;
  throw UserError("parameter autopilot: must be external or onboard");
}

}  // namespace stg::nodes

#pragma once

#include "auv_common/error.hpp"
#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {

/// The private parameter `autopilot` of agents and world: where a desired velocity becomes a
/// command. False, `external`: in a controller node. True, `onboard`: in the agent if force and
/// moment command the vehicle; in the world if the vehicle has an autopilot, because in a real
/// vehicle this is an inner loop. Throws UserError for any other value.
inline bool AutopilotOnBoardParameter() {
  const std::string autopilot = TextParameter("autopilot", "external");
  if (autopilot == "onboard") return true;
  if (autopilot == "external") return false;
  throw UserError("parameter autopilot: must be external or onboard");
}

}  // namespace stg::nodes

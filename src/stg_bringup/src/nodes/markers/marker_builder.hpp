#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "swarm_view.hpp"

namespace stg::nodes {

/// How a view is drawn. Vehicles and lines scale together; bands, walls and collision spheres keep
/// their true size.
struct MarkerStyle {
  double vehicle_scale = 1.0;  ///< 1: the hull fills its collision sphere
  bool whole_workspace =
      false;                   ///< walls, sensing range, legend; else the surroundings of target 0
  double trail_s = 60.0;       ///< simulated time that trails reach back
  double packet_s = 0.35;      ///< simulated time that a packet is shown travelling
  double lost_packet_s = 1.0;  ///< simulated time that a lost packet stays visible
  double prediction_s = 20.0;  ///< length of the target's velocity arrow
};

/// All markers of one view, frame world. Every namespace and id appears in every call, deleted
/// where there is nothing to show, so that a view never keeps what is gone.
visualization_msgs::MarkerArray BuildMarkers(const SwarmView& view, const MarkerStyle& style);

/// Names of the drop reasons of auv_msgs/LinkState.
const char* DropReasonName(std::uint8_t reason);

}  // namespace stg::nodes

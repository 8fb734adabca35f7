#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "shapes/marker_style.hpp"
#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// Draws the acoustic network: links; packets on their way; lost packets with the reasons; a ring
/// around each modem that sends, and the front of its sound. At receivers it shows where packets
/// collided, and which modem could not receive because it was sending.
void AddNetworkMarkers(const SwarmView& view, const MarkerStyle& style,
                       visualization_msgs::MarkerArray* array);

/// Names of the drop reasons of auv_msgs/LinkState.
const char* DropReasonName(std::uint8_t reason);

}  // namespace stg::nodes

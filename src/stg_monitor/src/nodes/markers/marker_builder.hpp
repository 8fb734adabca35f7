#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "shapes/marker_style.hpp"
#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// All markers of one view, frame world. Every call contains every namespace and id. A marker
/// without content is deleted, so a view never keeps old markers.
visualization_msgs::MarkerArray BuildMarkers(const SwarmView& view, const MarkerStyle& style);

}  // namespace stg::nodes

#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "shapes/marker_style.hpp"
#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// All markers of one view, frame world. Every namespace and id appears in every call, deleted
/// where there is nothing to show, so that a view never keeps what is gone.
visualization_msgs::MarkerArray BuildMarkers(const SwarmView& view, const MarkerStyle& style);

}  // namespace stg::nodes

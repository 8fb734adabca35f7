#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "shapes/marker_style.hpp"
#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// What the AUVs sense and believe of their targets: estimates with the ellipsoid of one standard
/// deviation, and fresh detections: a line in the direction measured, a horizontal circle at the
/// range measured, both of those for sensors that measure both.
void AddBeliefMarkers(const SwarmView& view, const MarkerStyle& style,
                      visualization_msgs::MarkerArray* array);

}  // namespace stg::nodes

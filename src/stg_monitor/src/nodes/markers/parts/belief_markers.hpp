#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "shapes/marker_style.hpp"
#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// Draws estimates of the targets with the ellipsoid of one standard deviation, the circle of the
/// radius d* around each of them, and fresh detections. The AUVs keep their places on this circle,
/// or near it: a law may choose another radius. With several targets, a broken line leads from each
/// AUV to the estimate of the target that it follows. A detection is a line in the measured
/// direction, a horizontal circle at the measured range, or both if the sensor measures both.
void AddBeliefMarkers(const SwarmView& view, const MarkerStyle& style,
                      visualization_msgs::MarkerArray* array);

}  // namespace stg::nodes

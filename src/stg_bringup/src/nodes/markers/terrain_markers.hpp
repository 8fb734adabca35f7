#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "auv_dynamics/terrain/terrain.hpp"
#include "swarm_view.hpp"

namespace stg::nodes {

/// The bottom of open water as a surface coloured by depth, contour lines every few cells, a frame
/// at the sea's surface, and the colours' scale in metres at its corner. It does not move: drawn
/// once for a scenario.
visualization_msgs::MarkerArray BuildTerrain(const SceneConfig& scene,
                                             const dynamics::Terrain& terrain);
/// Takes away what BuildTerrain drew.
visualization_msgs::MarkerArray NoTerrain();

}  // namespace stg::nodes

#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "auv_dynamics/terrain/seascape.hpp"
#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// The bottom of open water as a surface coloured by depth with lines on it, obstacles, a frame at
/// the sea's surface, and the colours' scale in metres at its corner. Nothing of it moves: drawn
/// once for a scenario.
visualization_msgs::MarkerArray BuildTerrain(const SceneConfig& scene,
                                             const dynamics::Seascape& sea);
/// Takes away what BuildTerrain drew.
visualization_msgs::MarkerArray NoTerrain();

}  // namespace stg::nodes

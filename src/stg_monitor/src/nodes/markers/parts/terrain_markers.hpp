#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "auv_dynamics/terrain/seascape.hpp"
#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// Draws the bottom of open water as a surface with depth colours and lines, obstacles, a frame at
/// the sea's surface, and the scale of colours in metres at its corner. Nothing of it moves, so it
/// is drawn once per scenario.
visualization_msgs::MarkerArray BuildTerrain(const SceneConfig& scene,
                                             const dynamics::Seascape& sea);
/// Removes the markers of BuildTerrain.
visualization_msgs::MarkerArray NoTerrain();

}  // namespace stg::nodes

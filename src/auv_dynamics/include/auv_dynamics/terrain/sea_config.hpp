#pragma once

#include <optional>
#include <string>
#include <vector>

#include "auv_common/config/field.hpp"

namespace stg::dynamics {

/// Open water instead of the box: a surface at z = 0, a bottom, and no walls. For packets,
/// observations and waypoints, workspace.half_extent_m is then the size of the region, not a wall.
struct SeaConfig {
  bool open = false;
  std::string terrain = "flat";  ///< or the name of a bathymetry, see TerrainFile
  double bottom_m = 120.0;       ///< depth of the flat bottom
  double latitude_deg = 0.0;     ///< of the world's origin, WGS 84
  double longitude_deg = 0.0;
  config::Interval auv_depth_m{20.0, 60.0};     ///< where AUVs start
  config::Interval target_depth_m{20.0, 60.0};  ///< where targets start and stay
  /// Rows of x, y, z of the centre and radius [m], world axes.
  std::vector<std::vector<double>> spheres;
  /// Upright: rows of x, y, z of the foot, radius and height [m], world axes.
  std::vector<std::vector<double>> cylinders;
};

/// Keys, units and ranges of the section `sea`, which a file may leave out.
void Describe(SeaConfig* c, config::Table* t);
/// Owner of keys that only a world with walls reads.
config::Owner WallsOwner(const SeaConfig* c);
/// The file of a bathymetry. A name that ends in .nc is the file itself. Otherwise <name>.nc is
/// searched in the folders of $STG_TERRAINS (separated by colons), and then in `terrain` beside the
/// folder of the shipped scenarios. Throws UserError that names the folders if there is no such
/// file.
std::string TerrainFile(const std::string& name);
/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const SeaConfig& c);

}  // namespace stg::dynamics

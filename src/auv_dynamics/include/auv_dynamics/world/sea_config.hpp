#pragma once

#include <optional>

#include "auv_common/config/field.hpp"

namespace stg::dynamics {

/// Open water instead of the box: a surface at z = 0, a bottom, and no walls. What scales with
/// workspace.half_extent_m (packets, observations, waypoints) then takes it for the size of the
/// region, not for a wall.
struct SeaConfig {
  bool open = false;
  double bottom_m = 120.0;                      ///< depth of the flat bottom
  config::Interval auv_depth_m{20.0, 60.0};     ///< where AUVs start
  config::Interval target_depth_m{20.0, 60.0};  ///< where targets start and stay
};

/// Keys, units and ranges of the section `sea`, which a file may leave out.
void Describe(SeaConfig* c, config::Table* t);
/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const SeaConfig& c);

}  // namespace stg::dynamics

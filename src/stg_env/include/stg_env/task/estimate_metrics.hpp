#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stg::task {

/// Errors of the AUVs' own estimates of their targets, if there are estimates [m]. "Own": the
/// vector from the AUV to its target, without the AUV's navigation error. "World": the position in
/// the world, with this error. Horizontal and vertical errors are separate, because ranges contain
/// little information about depths. The 95 % values are from a histogram whose bins are 5 % wide.
struct EstimateMetrics {
  double own_rmse = 0.0, own_rmse_tail = 0.0, own_95 = 0.0;        ///< horizontal
  double world_rmse = 0.0, world_rmse_tail = 0.0, world_95 = 0.0;  ///< horizontal
  double vertical_rmse = 0.0;
  double lost_in_world = 0.0;  ///< share of AUV decisions; a target is farther than
                               ///< task.lost_distance_m, or OffInWorld

  std::vector<std::pair<std::string, double>> Items() const;
};

/// Metrics of AUVs that surface for GPS fixes (localization.ranges.surface_std_m).
struct SurfacingMetrics {
  double fixes = 0.0;          ///< number of fixes of all AUVs
  double surface_share = 0.0;  ///< share of AUV decisions on the way up, at the surface or back
  /// Error of the own positions in the world over all AUVs at the decisions before a fix: the
  /// largest error between two fixes; 0: there was no fix [m].
  double rmse_before_fix = 0.0;
};

/// Horizontal errors of the positions that AUVs with a localizer estimate, east and north together
/// [m].
struct NavigationMetrics {
  double rmse = 0.0, rmse_tail = 0.0;  ///< of their own positions in the world
  double nees = 0.0;  ///< mean normalised square of these errors; 2 where they are consistent
  double relative_rmse = 0.0;  ///< of the others' positions relative to the own one
  std::optional<SurfacingMetrics> surfacing;

  std::vector<std::pair<std::string, double>> Items() const;
};

}  // namespace stg::task

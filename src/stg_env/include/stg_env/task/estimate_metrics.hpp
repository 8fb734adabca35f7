#pragma once

#include <string>
#include <utility>
#include <vector>

namespace stg::task {

/// How far the AUVs' own estimates of their targets are off, where there are any [m]. "Own": the
/// vector from the AUV to its target, which it steers by; its own navigation error is not in it.
/// "World": the position in the world, with that error. Horizontal errors stand apart from vertical
/// ones, as ranges hardly tell depths. The 95 % values are those of a histogram whose bins are 5 %
/// wide.
struct EstimateMetrics {
  double own_rmse = 0.0, own_rmse_tail = 0.0, own_95 = 0.0;        ///< horizontal
  double world_rmse = 0.0, world_rmse_tail = 0.0, world_95 = 0.0;  ///< horizontal
  double vertical_rmse = 0.0;
  double lost_in_world = 0.0;  ///< share of AUV decisions; a target is farther than
                               ///< task.lost_distance_m, or OffInWorld

  std::vector<std::pair<std::string, double>> Items() const;
};

/// How far AUVs with a localizer take themselves and each other to be from where they are,
/// horizontal, east and north together [m].
struct NavigationMetrics {
  double rmse = 0.0, rmse_tail = 0.0;  ///< of their own positions in the world
  double nees = 0.0;           ///< mean normalised square of these errors; 2 where it is consistent
  double relative_rmse = 0.0;  ///< of the others' positions against the own one

  std::vector<std::pair<std::string, double>> Items() const;
};

}  // namespace stg::task

#pragma once

#include <algorithm>

#include "swarm_view.hpp"

namespace stg::nodes {

/// How a view is drawn. Vehicles and lines scale together; bands, walls and collision spheres keep
/// their true size.
struct MarkerStyle {
  double vehicle_scale = 1.0;  ///< 1: the hull fills its collision sphere
  bool whole_workspace =
      false;                   ///< walls, sensing range, legend; else the surroundings of target 0
  double trail_s = 60.0;       ///< simulated time that trails reach back
  double packet_s = 0.35;      ///< simulated time that a packet is shown travelling
  double lost_packet_s = 1.0;  ///< simulated time that a lost packet stays visible
  double carrier_s = 0.3;      ///< simulated time that a carrier stays visible at least
  double prediction_s = 20.0;  ///< length of the target's velocity arrow
};

/// Radius of a vehicle as drawn [m]; every size that scales is a multiple. Large enough to be seen
/// in a view of a whole field, or of a band around a target.
inline double UnitOf(const SwarmView& view, const MarkerStyle& style) {
  const double unit = view.scene.radius_m * style.vehicle_scale;
  return std::max(unit, style.whole_workspace ? 0.03 * view.scene.shown_half_extent_m
                                              : 0.06 * view.scene.band_hi_m);
}
/// Height of letters [m].
inline double LettersOf(const SwarmView& view, const MarkerStyle& style) {
  return style.whole_workspace ? 0.05 * view.scene.shown_half_extent_m
                               : std::max(0.36 * UnitOf(view, style), 0.08 * view.scene.band_hi_m);
}
/// Simulated time that trails reach back: longer where decisions are.
inline double TrailSecondsOf(const SwarmView& view, const MarkerStyle& style) {
  if (!view.scene.sea.open) return style.trail_s;
  return std::max(style.trail_s, (style.whole_workspace ? 1500.0 : 300.0) * view.scene.decision_s);
}
inline constexpr int kManyVehicles = 8;  ///< beyond this, labels are numbers only

}  // namespace stg::nodes

#pragma once

#include <algorithm>

#include "swarm_view.hpp"

namespace stg::nodes {

/// Style of a view. Vehicles and lines have a common scale. Bands, walls and collision spheres keep
/// their true size.
struct MarkerStyle {
  double vehicle_scale = 1.0;  ///< 1: the hull fills its collision sphere
  /// Show walls, sensing range and legend; false: only the surroundings of target 0.
  bool whole_workspace = false;
  double trail_s = 60.0;       ///< trails show this simulated time
  double packet_s = 0.35;      ///< a packet travels for this simulated time
  double lost_packet_s = 1.0;  ///< a lost packet stays visible for this simulated time
  double carrier_s = 0.3;      ///< a carrier stays visible for at least this simulated time
  double prediction_s = 20.0;  ///< length of the target's velocity arrow
};

/// Drawn radius of a vehicle [m]. All sizes that scale are multiples of it. It is large enough to
/// be seen in a view of a whole field, or of a band around a target.
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
/// Simulated time that trails show; it is longer if decisions are longer.
inline double TrailSecondsOf(const SwarmView& view, const MarkerStyle& style) {
  if (!view.scene.sea.open) return style.trail_s;
  return std::max(style.trail_s, (style.whole_workspace ? 1500.0 : 300.0) * view.scene.decision_s);
}
inline constexpr int kManyVehicles = 8;  ///< beyond this, labels are numbers only

}  // namespace stg::nodes

#pragma once

#include <vector>

#include "auv_dynamics/targets/target_state.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"
#include "auv_dynamics/world/sea_config.hpp"

namespace stg::dynamics {

/// Surface and bottom of open water. A vehicle that reaches either stops there: its height is
/// clamped and the vertical part of its velocity, over ground, is taken from it. Coming to the
/// bottom is an event, counted once until the vehicle is off it again.
class Sea {
 public:
  Sea(const SeaConfig& config, int vehicles);

  /// An episode starts in one lane.
  void Reset(int lane);
  /// Keeps vehicle i between bottom and surface.
  void Apply(int i, VehicleState<Pack>* vehicle);
  /// Keeps targets within their depths.
  void Apply(std::vector<TargetState<Pack>>* targets) const;

  /// How often vehicle i has come to the bottom in this episode, and whether it lies on it now (1).
  const Pack& groundings(int i) const { return groundings_[static_cast<std::size_t>(i)]; }
  const Pack& aground(int i) const { return aground_[static_cast<std::size_t>(i)]; }

 private:
  SeaConfig config_;
  std::vector<Pack> groundings_, aground_;
};

}  // namespace stg::dynamics

#pragma once

#include "auv_dynamics/vehicle/vehicle_state.hpp"
#include "auv_dynamics/world/surroundings_config.hpp"

namespace stg::dynamics {

/// The box around the paper's scenarios, with the release's rule for vehicles that leave it.
class Walls {
 public:
  explicit Walls(const WorkspaceConfig& config) : config_(config) {}

  /// Clamps the position of a vehicle that is outside, turns outward world velocity back and slows
  /// the body.
  void Apply(VehicleState<Pack>* vehicle) const;

 private:
  WorkspaceConfig config_;
};

}  // namespace stg::dynamics

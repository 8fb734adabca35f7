#pragma once

#include "auv_dynamics/vehicle/vehicle.hpp"

namespace stg::dynamics {

/// A vehicle whose commands are speed, turn rate and climb rate (KinematicConfig). It stays level,
/// drifts with the current, and has neither contact nor disturbance. It is fast, and is for
/// research on decisions rather than on control. Each physics step is exact for the lags, and exact
/// to second order in dt for the turn.
class Kinematic : public Vehicle {
 public:
  explicit Kinematic(const VehicleConfig& config);

  /// speed [m/s], turn rate [rad/s, counter-clockwise from above], climb rate [m/s, up].
  const Space& actuators() const override { return actuators_; }
  /// Velocity in world axes.
  const Space& actions() const override { return actions_; }
  int internal_size() const override { return 2; }  // speed and climb rate through the water
  void Step(const Pack* command, const Surroundings& around, double dt, VehicleState<Pack>* state,
            Pack* internal) const override;

 private:
  Pack Within(std::size_t k, const Pack& x) const {
    return Clip(x, actuators_[k].lo, actuators_[k].hi);
  }

  KinematicConfig lags_;
  Space actuators_, actions_;
};

}  // namespace stg::dynamics

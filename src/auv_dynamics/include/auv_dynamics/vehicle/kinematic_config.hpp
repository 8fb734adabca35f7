#pragma once

#include "auv_common/config/field.hpp"

namespace stg::dynamics {

/// A vehicle whose commands are speed, turn rate and climb rate; it follows with first-order lags.
/// Its limits are those of the section `vehicle`: max_velocity_mps for speed (surge) and climb rate
/// (heave), max_rate_radps for the turn rate (yaw).
struct KinematicConfig {
  double min_speed_mps = 0.0;  ///< smallest speed; 0: the vehicle can stop
  double speed_lag_s = 2.0;
  double turn_lag_s = 1.0;
  double climb_lag_s = 2.0;
};

/// Keys, units and ranges of the section `vehicle.kinematic`, which a file may leave out.
void Describe(KinematicConfig* c, config::Table* t);

}  // namespace stg::dynamics

#pragma once

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/vehicle/vehicle_config.hpp"

namespace stg::dynamics {

/// Whether the first actuator of AUV i is the propeller of `vehicle.torpedo`, with commands as
/// shares of its largest rpm.
bool TurnsPropeller(const VehicleConfig& config, int i);

/// Mechanical power of a torpedo's shaft, P = 2 pi n Q with Q = rho n^2 D^5 K_Q(J) [W]. K_Q is the
/// same as in TorpedoModel: ahead it is linear in the advance number J = inflow speed / (n D), and
/// astern it has the value at J = 0. If the water turns the propeller, the power is 0, because no
/// energy is recovered.
/// @param rpm   shaft speed, positive ahead [rpm]
/// @param speed through the water [m/s]
template <class T>
T ShaftPower(const TorpedoConfig& c, const T& rpm, const T& speed) {
  const double D = c.propeller_diameter_m, per_turn = 1.0 / 60.0;
  const double scale = 2.0 * kPi * c.water_density_kgpm3 * D * D * D * D * D * per_turn * per_turn;
  const double slope = (c.torque_coefficient[1] - c.torque_coefficient[0]) / c.propeller_advance;
  const T turns = Abs(rpm);
  const T inflow = Select(rpm > T(0.0), speed * T(c.propeller_inflow / D), T(0.0));
  const T torque = T(c.torque_coefficient[0] * per_turn) * turns + T(slope) * inflow;
  return Max(T(0.0), T(scale) * turns * turns * torque);
}

}  // namespace stg::dynamics

#pragma once

#include <memory>
#include <string>

#include "auv_common/registry.hpp"
#include "auv_dynamics/autopilot/autopilot_config.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/vehicle/vehicle_config.hpp"

namespace stg::dynamics {

/// Turns a velocity command into commands of a vehicle's actuators, from the vehicle's own
/// navigation alone. It holds constants only: the state (integrals, estimates) is the caller's, so
/// one object serves a whole swarm. The same formula runs on one vehicle (T = double, a node) and
/// on the same vehicle of kLanes worlds (T = Pack), bit for bit.
class Autopilot {
 public:
  virtual ~Autopilot() = default;

  /// Numbers of its state; they are zero when an episode starts.
  virtual int state_size() const = 0;

  /// @param v_des_W desired velocity over ground, world axes [m/s], finite
  /// @param dt      time until the next call [s], positive
  /// @param state   [state_size()], in and out
  /// @param command [actuators of the vehicle], within their limits
  virtual void Steer(const Vec3<double>& v_des_W, const Navigation<double>& nav, double dt,
                     double* state, double* command) const = 0;
  virtual void Steer(const Vec3<Pack>& v_des_W, const Navigation<Pack>& nav, double dt, Pack* state,
                     Pack* command) const = 0;
};

/// By the name of the vehicle (`vehicle.model`) that each steers. A vehicle without one is
/// commanded by force and moment, Eqs. 24 to 26. A new one is a new file and one line in
/// src/autopilot/autopilots.cpp; one of another program is added with Add.
using AutopilotRegistry = Registry<const Autopilot, const VehicleConfig&, const AutopilotConfig&>;
AutopilotRegistry& Autopilots();

}  // namespace stg::dynamics

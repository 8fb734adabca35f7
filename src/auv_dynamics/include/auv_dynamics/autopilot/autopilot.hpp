#pragma once

#include <memory>
#include <string>

#include "auv_common/registry.hpp"
#include "auv_dynamics/autopilot/autopilot_config.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/vehicle/vehicle_config.hpp"

namespace stg::dynamics {

/// Converts a velocity command into commands to a vehicle's actuators, with the vehicle's own
/// navigation as the only other input. It holds only constants; the caller holds the state
/// (integrals, estimates), so one object serves a whole swarm. The same formula gives the same bits
/// for one vehicle (T = double, a node) and for the same vehicle of kLanes worlds (T = Pack).
class Autopilot {
 public:
  virtual ~Autopilot() = default;

  /// Size of its state; all numbers are zero when an episode starts.
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

/// Autopilots by the name of the vehicle (`vehicle.model`) that they steer. A vehicle without an
/// autopilot is commanded by force and moment, Eqs. 24 to 26. The keys of its own options are below
/// `control.autopilot`. To add an autopilot, write a new file and one line in
/// src/autopilot/autopilots.cpp; another program calls Add.
using AutopilotRegistry = Registry<const Autopilot, const VehicleConfig&, const AutopilotConfig&>;
AutopilotRegistry& Autopilots();

}  // namespace stg::dynamics

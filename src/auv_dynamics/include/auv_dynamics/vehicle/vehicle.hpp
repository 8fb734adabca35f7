#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "auv_common/registry.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/vehicle/vehicle_config.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// One number of a command.
struct Axis {
  std::string name;  ///< "rudder"
  std::string unit;  ///< "rad"
  double lo = 0.0, hi = 0.0;
};
using Space = std::vector<Axis>;

/// The action space of vehicles that a velocity command steers: velocity in world axes, each
/// component within the largest value of the section.
Space VelocityActions(const VehicleConfig& config);

/// External influences on a vehicle during one step.
struct Surroundings {
  const Vec3<Pack>& v_WC;           ///< current, world axes [m/s]
  const Vec3<Pack>& contact_W;      ///< force of other vehicles in contact, world axes [N]
  const Wrench<Pack>& disturbance;  ///< w of Eq. 3, body axes [N, N m]
};

/// Motion model of one kind of vehicle: its constants and its equations. It holds no state, so one
/// object serves a whole swarm in all lanes; the caller holds the state.
class Vehicle {
 public:
  virtual ~Vehicle() = default;

  /// Order, units and limits of a command to the actuators. Fixed for the life of the object.
  virtual const Space& actuators() const = 0;

  /// The action space of its controller (control/), each component in [-1, 1] of its limits; empty
  /// for a vehicle without a controller.
  virtual const Space& actions() const = 0;

  /// Number of packs for the state that is not in VehicleState, such as the state of the actuators
  /// (shaft speed, fin angles). They are zero when an episode starts.
  virtual int internal_size() const { return 0; }

  /// One physics step with a constant command.
  ///
  /// @param command  [actuators().size()], any finite values: limits are applied here
  /// @param dt       length of the step [s], positive
  /// @param state    in and out; all of it but rpy consistent on return, see FollowQuaternion
  /// @param internal [internal_size()], in and out
  virtual void Step(const Pack* command, const Surroundings& around, double dt,
                    VehicleState<Pack>* state, Pack* internal) const = 0;

  /// The orientation of a state as a unit quaternion, w x y z.
  virtual void Orientation(const VehicleState<Pack>& state, Pack (*q_WB)[4]) const {
    std::copy(state.q_WB, state.q_WB + 4, *q_WB);
  }
};

/// The names for `vehicle.model`. To add a kind, write a new file and one line in
/// src/vehicle/vehicles.cpp; another program calls Add before it loads a scenario.
using VehicleRegistry = Registry<const Vehicle, const VehicleConfig&>;
VehicleRegistry& Vehicles();

}  // namespace stg::dynamics

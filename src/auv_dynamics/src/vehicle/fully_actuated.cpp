#include "auv_dynamics/vehicle/fully_actuated.hpp"

#include "auv_dynamics/vehicle/integrator.hpp"

namespace stg::dynamics {

FullyActuated::FullyActuated(const VehicleConfig& config) : model_(config) {
  const char* const names[kWrenchSize] = {"X", "Y", "Z", "K", "M", "N"};
  for (int k = 0; k < kWrenchSize; ++k) {
    const double most = config.max_tau[static_cast<size_t>(k)];
    actuators_.push_back({names[k], k < 3 ? "N" : "N m", -most, most});
  }
  actions_ = VelocityActions(config);
}

void FullyActuated::Step(const Pack* command, const Surroundings& around, double dt,
                         VehicleState<Pack>* s, Pack*) const {
  Wrench<Pack> total{{command[0], command[1], command[2]}, {command[3], command[4], command[5]}};
  if (model_.config().float32_tau) {
    for (Pack* x : {&total.force.x, &total.force.y, &total.force.z, &total.moment.x,
                    &total.moment.y, &total.moment.z}) {
      *x = RoundToFloat(*x);
    }
  }
  // The release adds contact to the command before the actuator limits. w of Eq. 3 acts on the
  // hull, so it is added after the limits.
  total.force += s->R_WB.TransposeTimes(around.contact_W);
  total = model_.Limit(total);
  total.force += around.disturbance.force;
  total.moment += around.disturbance.moment;
  Integrate(model_, total, around.v_WC, dt, s);
}

void FullyActuated::Orientation(const VehicleState<Pack>& state, Pack (*q_WB)[4]) const {
  if (model_.config().integrator == Integrator::kSemiImplicit) {
    QuaternionOf(state.rpy, q_WB);
  } else {
    Vehicle::Orientation(state, q_WB);
  }
}

}  // namespace stg::dynamics

#include "auv_dynamics/vehicle/torpedo.hpp"

namespace stg::dynamics {

Torpedo::Torpedo(const VehicleConfig& config)
    : config_(config), model_(config.torpedo), actions_(VelocityActions(config)) {
  const double fin = config.torpedo.max_fin_rad, turns = config.torpedo.max_propeller_rpm;
  actuators_ = {{"propeller", "rpm", -turns, turns},
                {"rudder", "rad", -fin, fin},
                {"stern_plane", "rad", -fin, fin}};
}

void Torpedo::Step(const Pack* command, const Surroundings& around, double dt,
                   VehicleState<Pack>* s, Pack* internal) const {
  Wrench<Pack> w = around.disturbance;
  w.force += s->R_WB.TransposeTimes(around.contact_W);
  TorpedoActuators<Pack> actuators{internal[0], internal[1], internal[2]};
  Integrate(model_, config_,
            model_.Limit(TorpedoActuators<Pack>{command[0], command[1], command[2]}), w,
            around.v_WC, dt, s, &actuators);
  internal[0] = actuators.rpm;
  internal[1] = actuators.rudder;
  internal[2] = actuators.stern_plane;
}

void Torpedo::Orientation(const VehicleState<Pack>& state, Pack (*q_WB)[4]) const {
  if (config_.integrator == Integrator::kSemiImplicit) {
    QuaternionOf(state.rpy, q_WB);
  } else {
    Vehicle::Orientation(state, q_WB);
  }
}

}  // namespace stg::dynamics

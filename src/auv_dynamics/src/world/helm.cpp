#include "auv_dynamics/world/helm.hpp"

namespace stg::dynamics {

bool Helm::Steers(const WorldConfig& scenario) { return Autopilots().Has(scenario.vehicle.model); }

Helm::Helm(const WorldConfig& scenario)
    : autopilot_(
          Autopilots().Make(scenario.vehicle.model, scenario.vehicle, scenario.control.autopilot)),
      actuators_(Vehicles().Make(scenario.vehicle.model, scenario.vehicle)->actuators()),
      states_(static_cast<std::size_t>(autopilot_->state_size())),
      steps_(scenario.control.autopilot.period_steps),
      periods_(scenario.time.decision_steps / steps_),
      dt_s_(scenario.time.dt_s * steps_),
      state_(static_cast<std::size_t>(scenario.agents) * states_, Pack(0.0)),
      commands_(static_cast<std::size_t>(scenario.agents) * actuators_.size(), Pack(0.0)) {}

void Helm::Reset(int lane) {
  for (Pack& x : state_) SetLane(&x, lane, 0.0);
  for (Pack& x : commands_) SetLane(&x, lane, 0.0);
}

void Helm::Drive(const std::vector<Vec3<Pack>>& v_des_W, World* world) {
  for (int period = 0; period < periods_; ++period) {
    for (std::size_t i = 0; i < v_des_W.size(); ++i) {
      autopilot_->Steer(v_des_W[i], world->Nav(static_cast<int>(i)), dt_s_,
                        state_.data() + i * states_, commands_.data() + i * actuators_.size());
    }
    for (int k = 0; k < steps_; ++k) world->Step(commands_);
  }
}

void Helm::WriteShares(int i, Pack* shares) const {
  const Pack* command = commands_.data() + static_cast<std::size_t>(i) * actuators_.size();
  for (std::size_t k = 0; k < std::min<std::size_t>(actuators_.size(), kWrenchSize); ++k) {
    shares[k] = command[k] / Pack(LargestOf(actuators_[k]));
  }
}

}  // namespace stg::dynamics

#include "auv_dynamics/helm/helm.hpp"

namespace stg::dynamics {

bool Helm::Steers(const VehicleConfig& vehicle) { return Autopilots().Has(vehicle.model_of(0)); }

Helm::Helm(const VehicleConfig& vehicle, const VehicleConfig& believed,
           const AutopilotConfig& config, const RunConfig& run)
    : steps_(config.period_steps),
      periods_(run.time.decision_steps / steps_),
      dt_s_(run.time.dt_s * steps_) {
  const VehicleSet kinds(vehicle, run.agents);
  inputs_ = kinds.command_size();
  for (int i = 0; i < run.agents; ++i) {
    const std::string& model = vehicle.model_of(i);
    auto& autopilot = kinds_[model];
    if (autopilot == nullptr) {
      autopilot = Autopilots().Make(model, config.kinds, believed, config);
    }
    states_ = std::max(states_, static_cast<std::size_t>(autopilot->state_size()));
    autopilots_.push_back(autopilot.get());
    actuators_.push_back(kinds[i].actuators());
  }
  state_.assign(autopilots_.size() * states_, Pack(0.0));
  commands_.assign(autopilots_.size() * inputs_, Pack(0.0));
}

void Helm::Reset(int lane) {
  for (Pack& x : state_) SetLane(&x, lane, 0.0);
  for (Pack& x : commands_) SetLane(&x, lane, 0.0);
}

void Helm::Drive(const std::vector<Vec3<Pack>>& v_des_W, World* world) {
  for (int period = 0; period < periods_; ++period) {
    for (std::size_t i = 0; i < v_des_W.size(); ++i) {
      autopilots_[i]->Steer(v_des_W[i], world->Nav(static_cast<int>(i)), dt_s_,
                            state_.data() + i * states_, commands_.data() + i * inputs_);
    }
    for (int k = 0; k < steps_; ++k) world->Step(commands_);
  }
}

void Helm::WriteShares(int i, Pack* shares) const {
  const Pack* command = commands_.data() + static_cast<std::size_t>(i) * inputs_;
  const Space& axes = actuators_[static_cast<std::size_t>(i)];
  for (std::size_t k = 0; k < std::min<std::size_t>(axes.size(), kWrenchSize); ++k) {
    shares[k] = command[k] / Pack(LargestOf(axes[k]));
  }
}

}  // namespace stg::dynamics

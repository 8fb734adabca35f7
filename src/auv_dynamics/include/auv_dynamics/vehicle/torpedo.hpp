#pragma once

#include <algorithm>
#include <cmath>

#include "auv_dynamics/vehicle/integrator.hpp"
#include "auv_dynamics/vehicle/torpedo_model.hpp"
#include "auv_dynamics/vehicle/vehicle.hpp"

namespace stg::dynamics {

/// One physics step of a torpedo by the configured integrator and substeps. Runge-Kutta: the
/// actuators follow the command with their lags, exactly, also between the stages of a step.
/// Semi-implicit: by explicit Euler, as everything else in it.
///
/// @param command   within the limits of the model
/// @param w         force and moment besides those of water, weight and actuators, body axes
/// @param v_WC      current, world axes [m/s]
/// @param s, actuators in and out
template <class T>
void Integrate(const TorpedoModel& model, const VehicleConfig& config,
               const TorpedoActuators<T>& command, const Wrench<T>& w, const Vec3<T>& v_WC,
               double dt, VehicleState<T>* s, TorpedoActuators<T>* actuators) {
  const double h = dt / config.substeps;
  const double fin_lag = model.config().fin_lag_s, shaft_lag = model.config().propeller_lag_s;
  const bool euler = config.integrator == Integrator::kSemiImplicit;
  // Remaining share of the difference to the command after half a step.
  const double fin = std::exp(-0.5 * h / fin_lag), shaft = std::exp(-0.5 * h / shaft_lag);
  const auto after = [&](double fin_left, double shaft_left) {
    const TorpedoActuators<T>& from = *actuators;
    return TorpedoActuators<T>{
        command.rpm + (from.rpm - command.rpm) * T(shaft_left),
        command.rudder + (from.rudder - command.rudder) * T(fin_left),
        command.stern_plane + (from.stern_plane - command.stern_plane) * T(fin_left)};
  };
  const auto limit = [](const BodyVelocity<T>& nu) { return nu; };
  for (int k = 0; k < config.substeps; ++k) {
    const TorpedoActuators<T> middle = after(fin, shaft);
    const TorpedoActuators<T> end =
        euler ? after(std::max(0.0, 1.0 - h / fin_lag), std::max(0.0, 1.0 - h / shaft_lag))
              : after(fin * fin, shaft * shaft);
    const auto accelerate = [&](const Mat3<T>& R_WB, const BodyVelocity<T>& nu, double c) {
      const TorpedoActuators<T>& now = c == 0.0 ? *actuators : c == 1.0 ? end : middle;
      return model.Acceleration(R_WB, nu, now, w, v_WC);
    };
    if (euler) {
      StepSemiImplicit(accelerate, limit, h, s);
    } else {
      StepRk4(accelerate, limit, h, s);
    }
    *actuators = end;
  }
  if (!euler) FollowQuaternion(s);
}

/// A hull with a propeller, a rudder and a stern plane (TorpedoModel), behind the interface of all
/// vehicles.
class Torpedo : public Vehicle {
 public:
  /// Throws UserError, as TorpedoModel does.
  explicit Torpedo(const VehicleConfig& config);

  /// propeller [rpm], rudder [rad], stern plane [rad].
  const Space& actuators() const override { return actuators_; }
  /// Velocity in world axes, which an autopilot turns into commands of the actuators.
  const Space& actions() const override { return actions_; }
  int internal_size() const override { return 3; }
  void Step(const Pack* command, const Surroundings& around, double dt, VehicleState<Pack>* state,
            Pack* internal) const override;
  void Orientation(const VehicleState<Pack>& state, Pack (*q_WB)[4]) const override;

 private:
  VehicleConfig config_;
  TorpedoModel model_;
  Space actuators_, actions_;
};

}  // namespace stg::dynamics

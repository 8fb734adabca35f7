#pragma once

#include "auv_dynamics/autopilot/autopilot.hpp"
#include "auv_dynamics/vehicle/torpedo_model.hpp"

namespace stg::dynamics {

/// Controls the speed by the shaft, the course by the rudder, and the climb rate by the stern plane
/// through the pitch. Each loop has an integral that stops at the limits. The effect of a fin is
/// taken from the model of the vehicle at the speed through the water. This speed is estimated from
/// the shaft speed, because a log over ground does not measure it.
class TorpedoAutopilot : public Autopilot {
 public:
  TorpedoAutopilot(const VehicleConfig& vehicle, const AutopilotConfig& config);

  int state_size() const override { return kStates; }
  void Steer(const Vec3<double>& v_des_W, const Navigation<double>& nav, double dt, double* state,
             double* command) const override {
    Follow(v_des_W, nav, dt, state, command);
  }
  void Steer(const Vec3<Pack>& v_des_W, const Navigation<Pack>& nav, double dt, Pack* state,
             Pack* command) const override {
    Follow(v_des_W, nav, dt, state, command);
  }

 private:
  enum State { kFlow, kSpeed, kTurn, kClimb, kPitch, kStates };

  template <class T>
  void Follow(const Vec3<T>& v_des_W, const Navigation<T>& nav, double dt, T* state,
              T* command) const;
  template <class T>
  T Shaft(const T& wanted, const T& speed, double dt, T* state) const;
  template <class T>
  T Rudder(const T& wanted, const T& rate, const T& flow, double dt, T* state) const;
  template <class T>
  T SternPlane(const T& wanted, const T& climb, const T& sine, const T& rate, const T& flow,
               double dt, T* state) const;

  AutopilotConfig c_;
  TorpedoModel model_;
  double max_rpm_, max_fin_, rpm_per_speed_, slowest_;
  double turn_authority_, turn_damping_;    // [1/m^2] of the rudder, [1/s]
  double pitch_authority_, pitch_damping_;  // [1/m^2] of the stern plane, [1/s]
  double righting_;                         // [1/s^2] of the sine of pitch
};

}  // namespace stg::dynamics

#pragma once

#include "auv_dynamics/autopilot/autopilot.hpp"
#include "course.hpp"

namespace stg::dynamics {

/// Uses the command itself as speed, turn rate and climb rate. Only the course is corrected for a
/// current.
class KinematicAutopilot : public Autopilot {
 public:
  KinematicAutopilot(const VehicleConfig& vehicle, const AutopilotConfig& config)
      : c_(config), vehicle_(vehicle) {}

  int state_size() const override { return 0; }
  void Steer(const Vec3<double>& v_des_W, const Navigation<double>& nav, double, double*,
             double* command) const override {
    Follow(v_des_W, nav, command);
  }
  void Steer(const Vec3<Pack>& v_des_W, const Navigation<Pack>& nav, double, Pack*,
             Pack* command) const override {
    Follow(v_des_W, nav, command);
  }

 private:
  template <class T>
  void Follow(const Vec3<T>& v_des_W, const Navigation<T>& nav, T* command) const {
    const Mat3<T> R_WB = RotationOf(nav.q_WB);
    const Wish<T> wish = WishOf(c_, v_des_W, R_WB, R_WB * nav.v_WB_B);
    const T turn(vehicle_.max_rate_radps[2]), climb(vehicle_.max_velocity_mps[2]);
    command[0] = Min(wish.speed, T(vehicle_.max_velocity_mps[0]));
    command[1] = Clip(wish.turn_rate, -turn, turn);
    command[2] = Clip(wish.climb, -climb, climb);
  }

  AutopilotConfig c_;
  VehicleConfig vehicle_;
};

}  // namespace stg::dynamics

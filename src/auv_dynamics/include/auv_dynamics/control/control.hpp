#pragma once

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/control/control_config.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/vehicle/vehicle_config.hpp"

/// From a policy's action to force and torque (Eqs. 22-27).
namespace stg::dynamics {

/// Rate limit, then smoothing, both against the previous smoothed action
/// (Eq. 27): previous[k] becomes the action that is executed. `size` is 3 or 6.
template <class T>
inline void SmoothAction(const ControlConfig& c, int size, const T* action, T* previous) {
  for (int k = 0; k < size; ++k) {
    T a = Clip(action[k], T(-1.0), T(1.0));
    if (c.max_delta > 0.0) {
      a = previous[k] + Clip(a - previous[k], T(-c.max_delta), T(c.max_delta));
    }
    previous[k] = T(1.0 - c.smoothing) * a + T(c.smoothing) * previous[k];
  }
}

/// v_des = s_v a, world axes [m/s] (Eq. 23): an action of 1 asks for the maximum
/// speed of that axis.
template <class T>
inline Vec3<T> DesiredVelocity(const VehicleConfig& v, const T* action) {
  return {action[0] * T(v.max_velocity_mps[0]), action[1] * T(v.max_velocity_mps[1]),
          action[2] * T(v.max_velocity_mps[2])};
}

/// Generalised force [N, N m] from fractions of its maximum.
template <class T>
inline Wrench<T> ScaleWrench(const VehicleConfig& v, const T* fraction) {
  const auto& t = v.max_tau;
  return {{fraction[0] * T(t[0]), fraction[1] * T(t[1]), fraction[2] * T(t[2])},
          {fraction[3] * T(t[3]), fraction[4] * T(t[4]), fraction[5] * T(t[5])}};
}

/// Velocity controller (Eqs. 24-26). Writes tau / tau_max, six fractions in
/// [-1, 1], to `fraction`.
///
/// @param v_des_W desired velocity, world axes [m/s]
/// @param v_WB    velocity over ground, world axes [m/s]
/// @param rpy     roll, pitch, yaw [rad]
template <class T>
inline void VelocityController(const ControlConfig& c, const VehicleConfig& v,
                               const Vec3<T>& v_des_W, const Mat3<T>& R_WB, const Vec3<T>& v_WB,
                               const Vec3<T>& rpy, const Vec3<T>& w_WB_B, T* fraction) {
  const auto& vmax = v.max_velocity_mps;
  const auto& wmax = v.max_rate_radps;
  const Vec3<T> error = R_WB.TransposeTimes(v_des_W - v_WB);
  const T lo(-1.0), hi(1.0);
  fraction[0] = Clip(error.x * T(c.velocity_gain / vmax[0]), lo, hi);
  fraction[1] = Clip(error.y * T(c.velocity_gain / vmax[1]), lo, hi);
  fraction[2] = Clip(error.z * T(c.velocity_gain / vmax[2]), lo, hi);
  Vec3<T> attitude{T(-c.attitude_gain) * rpy.x, T(-c.attitude_gain) * rpy.y, T(0.0)};
  if (c.heading == HeadingMode::kAlongVelocity) {
    // The bow points along the command, if the command has a direction.
    const Vec3<T> b = R_WB.TransposeTimes(v_des_W);
    const T horizontal = Sqrt(b.x * b.x + b.y * b.y);
    const Mask<T> moving = Dot(b, b) > T(1e-6 * vmax[0] * vmax[0]);
    const T gain(c.heading_gain);
    attitude.y = Select(moving, -gain * Atan2(b.z, horizontal), attitude.y);
    attitude.z = Select(moving, gain * Atan2(b.y, b.x), T(0.0));
  }
  fraction[3] = Clip(attitude.x - w_WB_B.x * T(c.rate_gain / wmax[0]), lo, hi);
  fraction[4] = Clip(attitude.y - w_WB_B.y * T(c.rate_gain / wmax[1]), lo, hi);
  fraction[5] = Clip(attitude.z - w_WB_B.z * T(c.rate_gain / wmax[2]), lo, hi);
}

/// Executes an action (Eqs. 23-27), from the desired action to the force, for both interfaces.
/// velocity3: rate limit, smoothing, desired velocity, velocity controller. tau6: the action,
/// clipped, is the force.
///
/// @param wanted   [action size] action of the policy
/// @param rpy      called for velocity3 only: roll, pitch, yaw [rad]; angles cost arc tangents
/// @param executed [action size] in: the last executed action; out: the present one
/// @param fraction [kWrenchSize] out: tau / tau_max; other parameters as VelocityController
/// @return the desired velocity, world axes [m/s]; zero for tau6
template <class T, class Rpy>
inline Vec3<T> ExecuteAction(const ControlConfig& c, const VehicleConfig& v, const T* wanted,
                             const Mat3<T>& R_WB, const Vec3<T>& v_WB, const Rpy& rpy,
                             const Vec3<T>& w_WB_B, T* executed, T* fraction) {
  const int size = ActionSize(c.interface);
  if (c.interface == ActionInterface::kTau6) {
    for (int k = 0; k < size; ++k) {
      fraction[k] = executed[k] = Clip(wanted[k], T(-1.0), T(1.0));
    }
    return {};
  }
  SmoothAction(c, size, wanted, executed);
  const Vec3<T> v_des_W = DesiredVelocity(v, executed);
  VelocityController(c, v, v_des_W, R_WB, v_WB, rpy(), w_WB_B, fraction);
  return v_des_W;
}

/// The action for a desired velocity, which is given as an action of velocity3: the same action, or
/// for tau6 the output of the velocity controller. May be in place.
/// @param velocity [3] v / v_max, world axes
/// @param action   [action size]
template <class T, class Rpy>
inline void ActionForVelocity(const ControlConfig& c, const VehicleConfig& v, const T* velocity,
                              const Mat3<T>& R_WB, const Vec3<T>& v_WB, const Rpy& rpy,
                              const Vec3<T>& w_WB_B, T* action) {
  if (c.interface == ActionInterface::kTau6) {
    VelocityController(c, v, DesiredVelocity(v, velocity), R_WB, v_WB, rpy(), w_WB_B, action);
    return;
  }
  for (int k = 0; k < ActionSize(c.interface); ++k) action[k] = velocity[k];
}

/// VelocityController from a navigation state, for the controller node.
inline void VelocityController(const ControlConfig& c, const VehicleConfig& v,
                               const Vec3<double>& v_des_W, const NavState& nav, double* fraction) {
  const Mat3<double> R_WB = RotationOf(nav.q_WB);
  VelocityController(c, v, v_des_W, R_WB, R_WB * nav.v_WB_B, RpyOf(TrigOf(R_WB)), nav.w_WB_B,
                     fraction);
}

}  // namespace stg::dynamics

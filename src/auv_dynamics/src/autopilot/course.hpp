#pragma once

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/autopilot/autopilot_config.hpp"
#include "auv_dynamics/measurements.hpp"

namespace stg::dynamics {

/// Wanted motion for both autopilots, from a velocity command and the navigation.
template <class T>
struct Wish {
  T speed;      ///< over ground, horizontal [m/s]; not below the smallest speed
  T turn_rate;  ///< [rad/s], counter-clockwise from above
  T climb;      ///< [m/s], up
};

/// Below this speed over ground the heading is used as the course [m/s].
inline constexpr double kSteerageWay_mps = 0.3;
/// A slower horizontal command has no direction, and the vehicle goes straight on [m/s].
inline constexpr double kNoDirection_mps = 1e-3;

/// Computes the turn of the course over ground towards the course of the command.
/// @param v_WB velocity over ground, world axes
template <class T>
inline Wish<T> WishOf(const AutopilotConfig& c, const Vec3<T>& v_des_W, const Mat3<T>& R_WB,
                      const Vec3<T>& v_WB) {
  const T wanted = Sqrt(v_des_W.x * v_des_W.x + v_des_W.y * v_des_W.y);
  const T over_ground = Sqrt(v_WB.x * v_WB.x + v_WB.y * v_WB.y);
  const Mask<T> under_way = over_ground > T(kSteerageWay_mps);
  const T east = Select(under_way, v_WB.x, R_WB.m[0][0]);
  const T north = Select(under_way, v_WB.y, R_WB.m[1][0]);
  // Angle from the course to the command.
  const T across = east * v_des_W.y - north * v_des_W.x;
  const T along = east * v_des_W.x + north * v_des_W.y;
  const Mask<T> directed = wanted > T(kNoDirection_mps);
  const T error = Select(
      directed, Atan2(Select(directed, across, T(0.0)), Select(directed, along, T(1.0))), T(0.0));
  const T most(c.max_turn_rate_radps);
  return {Max(wanted, T(c.min_speed_mps)), Clip(error * T(c.course_gain_ps), -most, most),
          v_des_W.z};
}

/// Adds to an integral, except when its output is at the limit and the increment would drive it
/// further.
/// @param raw, limited output before and after the limit, both of this step
template <class T>
inline void Integrate(const T& increment, const T& raw, const T& limited, T* integral) {
  const Mask<T> pushing = (raw - limited) * increment > T(0.0);
  *integral += Select(pushing, T(0.0), increment);
}

}  // namespace stg::dynamics

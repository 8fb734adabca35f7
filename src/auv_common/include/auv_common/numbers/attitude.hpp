#pragma once

#include "auv_common/numbers/vector.hpp"

/// Attitude of the body B (FLU) in the world W (ENU): R_WB = Rz(psi) Ry(theta)
/// Rx(phi), Fossen's zyx convention. Quaternions are w x y z.
namespace stg {

inline constexpr double kPi = 3.14159265358979323846;

/// Angle in [-pi, pi).
template <class T>
inline T WrapAngle(const T& a) {
  return a - T(2.0 * kPi) * Floor((a + T(kPi)) * T(1.0 / (2.0 * kPi)));
}

/// Sines and cosines of roll, pitch and yaw. R_WB, the rate map and the observation need nothing
/// else.
template <class T>
struct EulerTrig {
  T sin_phi, cos_phi, sin_theta, cos_theta, sin_psi, cos_psi;
};

template <class T>
inline EulerTrig<T> TrigOf(const Vec3<T>& rpy) {
  EulerTrig<T> t;
  SinCos(rpy.x, &t.sin_phi, &t.cos_phi);
  SinCos(rpy.y, &t.sin_theta, &t.cos_theta);
  SinCos(rpy.z, &t.sin_psi, &t.cos_psi);
  return t;
}

template <class T>
inline Mat3<T> RotationOf(const EulerTrig<T>& t) {
  Mat3<T> R;
  R.m[0][0] = t.cos_psi * t.cos_theta;
  R.m[0][1] = t.cos_psi * t.sin_theta * t.sin_phi - t.sin_psi * t.cos_phi;
  R.m[0][2] = t.cos_psi * t.sin_theta * t.cos_phi + t.sin_psi * t.sin_phi;
  R.m[1][0] = t.sin_psi * t.cos_theta;
  R.m[1][1] = t.sin_psi * t.sin_theta * t.sin_phi + t.cos_psi * t.cos_phi;
  R.m[1][2] = t.sin_psi * t.sin_theta * t.cos_phi - t.cos_psi * t.sin_phi;
  R.m[2][0] = -t.sin_theta;
  R.m[2][1] = t.cos_theta * t.sin_phi;
  R.m[2][2] = t.cos_theta * t.cos_phi;
  return R;
}

/// Rotation matrix of a quaternion q != 0 of any norm; two = 2 / |q|^2.
template <class T>
inline Mat3<T> RotationOf(const T (&q)[4], const T& two) {
  const T one(1.0);
  const T &w = q[0], &x = q[1], &y = q[2], &z = q[3];
  Mat3<T> R;
  R.m[0][0] = one - two * (y * y + z * z);
  R.m[0][1] = two * (x * y - w * z);
  R.m[0][2] = two * (x * z + w * y);
  R.m[1][0] = two * (x * y + w * z);
  R.m[1][1] = one - two * (x * x + z * z);
  R.m[1][2] = two * (y * z - w * x);
  R.m[2][0] = two * (x * z - w * y);
  R.m[2][1] = two * (y * z + w * x);
  R.m[2][2] = one - two * (x * x + y * y);
  return R;
}

/// Rotation matrix of a unit quaternion.
template <class T>
inline Mat3<T> RotationOf(const T (&q)[4]) {
  return RotationOf(q, T(2.0));
}

/// Sines and cosines of roll, pitch and yaw of a rotation matrix, without computing an angle. At
/// pitch +-90 deg, where roll and yaw are not unique, roll is zero.
template <class T>
inline EulerTrig<T> TrigOf(const Mat3<T>& R) {
  const T one(1.0), zero(0.0);
  EulerTrig<T> t;
  t.sin_theta = Clip(-R.m[2][0], -1.0, 1.0);
  t.cos_theta = Sqrt(R.m[0][0] * R.m[0][0] + R.m[1][0] * R.m[1][0]);
  const Mask<T> gimbal = t.cos_theta < T(1e-9);
  const T inv = one / Select(gimbal, one, t.cos_theta);
  t.sin_phi = Select(gimbal, zero, R.m[2][1] * inv);
  t.cos_phi = Select(gimbal, one, R.m[2][2] * inv);
  t.sin_psi = Select(gimbal, -R.m[0][1], R.m[1][0] * inv);
  t.cos_psi = Select(gimbal, R.m[1][1], R.m[0][0] * inv);
  return t;
}

/// Roll, pitch and yaw [rad] of their sines and cosines.
template <class T>
inline Vec3<T> RpyOf(const EulerTrig<T>& t) {
  return {Atan2(t.sin_phi, t.cos_phi), Atan2(t.sin_theta, t.cos_theta),
          Atan2(t.sin_psi, t.cos_psi)};
}

/// Unit quaternion of roll, pitch, yaw, with w >= 0.
template <class T>
inline void QuaternionOf(const Vec3<T>& rpy, T (*q)[4]) {
  const EulerTrig<T> h = TrigOf(rpy * T(0.5));
  const T w = h.cos_phi * h.cos_theta * h.cos_psi + h.sin_phi * h.sin_theta * h.sin_psi;
  const T x = h.sin_phi * h.cos_theta * h.cos_psi - h.cos_phi * h.sin_theta * h.sin_psi;
  const T y = h.cos_phi * h.sin_theta * h.cos_psi + h.sin_phi * h.cos_theta * h.sin_psi;
  const T z = h.cos_phi * h.cos_theta * h.sin_psi - h.sin_phi * h.sin_theta * h.cos_psi;
  const T sign = Select(w < T(0.0), T(-1.0), T(1.0));
  (*q)[0] = sign * w;
  (*q)[1] = sign * x;
  (*q)[2] = sign * y;
  (*q)[3] = sign * z;
}

/// Euler angle rates of body rates p q r (Fossen's T_Theta). The cosine of pitch is kept away from
/// zero, so the rates stay finite at pitch +-90 deg.
template <class T>
inline Vec3<T> EulerRates(const EulerTrig<T>& t, const Vec3<T>& w_WB_B) {
  const T eps(1e-6);
  const T c = Select(Abs(t.cos_theta) < eps, Select(t.cos_theta < T(0.0), -eps, eps), t.cos_theta);
  const T along = (t.sin_phi * w_WB_B.y + t.cos_phi * w_WB_B.z) / c;
  return {w_WB_B.x + along * t.sin_theta, t.cos_phi * w_WB_B.y - t.sin_phi * w_WB_B.z, along};
}

}  // namespace stg

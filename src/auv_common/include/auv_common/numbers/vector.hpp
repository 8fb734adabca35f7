#pragma once

#include "auv_common/numbers/lanes.hpp"

/// Vectors and rotation matrices over one number type.
namespace stg {

/// Three components of one quantity. The name of a variable says the frame.
template <class T>
struct Vec3 {
  // Not x{0.0}: a Pack would take this as a list of lanes.
  T x = T(0.0), y = T(0.0), z = T(0.0);

  Vec3 operator+(const Vec3& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Vec3 operator-(const Vec3& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Vec3 operator-() const { return {-x, -y, -z}; }
  Vec3 operator*(const T& s) const { return {x * s, y * s, z * s}; }
  Vec3& operator+=(const Vec3& o) { return *this = *this + o; }
};
template <class T>
inline T Dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
inline Vec3<T> Cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
inline T Norm(const Vec3<T>& a) {
  return Sqrt(Dot(a, a));
}
/// Component-wise product and quotient with one constant per axis.
template <class T>
inline Vec3<T> Scale(const Vec3<T>& a, const Vec3<double>& s) {
  return {a.x * T(s.x), a.y * T(s.y), a.z * T(s.z)};
}
template <class T>
inline Vec3<T> Clip(const Vec3<T>& a, double lo, double hi) {
  return {Clip(a.x, lo, hi), Clip(a.y, lo, hi), Clip(a.z, lo, hi)};
}
template <class T>
inline Vec3<T> Select(const Mask<T>& m, const Vec3<T>& a, const Vec3<T>& b) {
  return {Select(m, a.x, b.x), Select(m, a.y, b.y), Select(m, a.z, b.z)};
}
/// Zero in every lane where the number is finite, and NaN in the others. One comparison of a sum of
/// these values checks many numbers.
template <class T>
inline T NonFiniteness(const T& a) {
  return a - a;
}
template <class T>
inline T NonFiniteness(const Vec3<T>& a) {
  return (a.x - a.x) + (a.y - a.y) + (a.z - a.z);
}
/// True if the vector is finite in all lanes.
template <class T>
inline bool Finite(const Vec3<T>& a) {
  return !Any(!(NonFiniteness(a) == T(0.0)));
}
template <class T>
inline Vec3<double> Lane(const Vec3<T>& a, int lane) {
  return {Lane(a.x, lane), Lane(a.y, lane), Lane(a.z, lane)};
}
template <class T>
inline void SetLane(Vec3<T>* a, int lane, const Vec3<double>& v) {
  SetLane(&a->x, lane, v.x);
  SetLane(&a->y, lane, v.y);
  SetLane(&a->z, lane, v.z);
}
inline Vec3<Pack> Broadcast(const Vec3<double>& v) { return {Pack(v.x), Pack(v.y), Pack(v.z)}; }

/// Rotation matrix R_WB. Its columns are the body axes in the world frame.
template <class T>
struct Mat3 {
  T m[3][3];

  Vec3<T> operator*(const Vec3<T>& v) const {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
            m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
  }
  /// R_WB^T v: world components to body components.
  Vec3<T> TransposeTimes(const Vec3<T>& v) const {
    return {m[0][0] * v.x + m[1][0] * v.y + m[2][0] * v.z,
            m[0][1] * v.x + m[1][1] * v.y + m[2][1] * v.z,
            m[0][2] * v.x + m[1][2] * v.y + m[2][2] * v.z};
  }
};

}  // namespace stg

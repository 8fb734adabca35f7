#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <xsimd/xsimd.hpp>

/// Scalar and SIMD arithmetic behind one set of names.
///
/// Every formula of the core is a template over T, which is `double` (one
/// vehicle, one agent) or `Pack` (the same quantity of kLanes independent
/// environments). Transcendental functions of a double are evaluated through a
/// Pack, so that both instantiations round alike: a ROS node and the vectorised
/// environment then agree bit for bit (the build sets -ffp-contract=off).
namespace stg {

using Pack = xsimd::batch<double>;
inline constexpr int kLanes = static_cast<int>(Pack::size);

/// What comparing two T gives: Mask<double> is bool, Mask<Pack> one truth per lane.
template <class T>
struct MaskOf;
template <>
struct MaskOf<double> {
  using type = bool;
};
template <>
struct MaskOf<Pack> {
  using type = Pack::batch_bool_type;
};
template <class T>
using Mask = typename MaskOf<T>::type;

inline double Select(bool m, double a, double b) { return m ? a : b; }
inline Pack Select(const Pack::batch_bool_type& m, const Pack& a, const Pack& b) {
  return xsimd::select(m, a, b);
}
inline bool Any(bool m) { return m; }
inline bool Any(const Pack::batch_bool_type& m) { return xsimd::any(m); }

inline double Min(double a, double b) { return std::min(a, b); }
inline Pack Min(const Pack& a, const Pack& b) { return xsimd::min(a, b); }
inline double Max(double a, double b) { return std::max(a, b); }
inline Pack Max(const Pack& a, const Pack& b) { return xsimd::max(a, b); }
inline double Abs(double a) { return std::abs(a); }
inline Pack Abs(const Pack& a) { return xsimd::abs(a); }
inline double Sqrt(double a) { return std::sqrt(a); }
inline Pack Sqrt(const Pack& a) { return xsimd::sqrt(a); }
inline double Floor(double a) { return std::floor(a); }
inline Pack Floor(const Pack& a) { return xsimd::floor(a); }

inline Pack Exp(const Pack& a) { return xsimd::exp(a); }
inline double Exp(double a) { return Exp(Pack(a)).get(0); }
inline Pack Log1p(const Pack& a) { return xsimd::log1p(a); }
inline double Log1p(double a) { return Log1p(Pack(a)).get(0); }
inline Pack Atan2(const Pack& y, const Pack& x) { return xsimd::atan2(y, x); }
inline double Atan2(double y, double x) { return Atan2(Pack(y), Pack(x)).get(0); }
inline void SinCos(const Pack& a, Pack* s, Pack* c) {
  const auto sc = xsimd::sincos(a);
  *s = sc.first;
  *c = sc.second;
}
inline void SinCos(double a, double* s, double* c) {
  const auto sc = xsimd::sincos(Pack(a));
  *s = sc.first.get(0);
  *c = sc.second.get(0);
}

/// Nearest number with float32's 24-bit significand, by Veltkamp's splitting.
/// Not a pair of casts: GCC 12 at -O3 drops a vectorised double-float-double
/// round trip. Exact for float32's normal range, which is all it is used for.
template <class T>
inline T RoundToFloat(const T& a) {
  const T c = a * T(536870913.0);  // 2^29 + 1
  return c - (c - a);
}

/// Value of one lane; a double has the same value in every lane.
inline double Lane(double a, int) { return a; }
// One load or store where the pack lies; Pack::get copies the whole pack first.
inline double Lane(const Pack& a, int lane) {
  double value;
  std::memcpy(&value, reinterpret_cast<const double*>(&a) + lane, sizeof(value));
  return value;
}
inline void SetLane(double* a, int, double value) { *a = value; }
inline void SetLane(Pack* a, int lane, double value) {
  std::memcpy(reinterpret_cast<double*>(a) + lane, &value, sizeof(value));
}

template <class T>
inline T Clip(const T& a, const T& lo, const T& hi) {
  return Min(Max(a, lo), hi);
}
inline Pack Clip(const Pack& a, double lo, double hi) { return Clip(a, Pack(lo), Pack(hi)); }

/// Three components of one quantity, in the frame its name says.
template <class T>
struct Vec3 {
  // Not x{0.0}: a Pack would take that as a list of lanes.
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
/// Component-wise product and quotient with per-axis constants.
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

/// Rotation matrix R_WB, rows in the world frame, columns the body axes.
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

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <xsimd/xsimd.hpp>

/// Scalar and SIMD arithmetic with the same names.
///
/// Every formula of the core is a template over T. T is `double` (one vehicle, one agent) or `Pack`
/// (the same quantity in kLanes independent environments). Transcendental functions of a double are
/// evaluated through a Pack, so that both round alike. So a ROS node and the vectorised environment
/// agree bit for bit (the build sets -ffp-contract=off).
namespace stg {

using Pack = xsimd::batch<double>;
inline constexpr int kLanes = static_cast<int>(Pack::size);

/// Number of lanes of a T.
template <class T>
inline constexpr int kLanesOf = std::is_same_v<T, Pack> ? kLanes : 1;

/// One V for every lane of a T, where V is a time or a count. OfLane reads it.
template <class T, class V>
using PerLane = std::conditional_t<std::is_same_v<T, Pack>, std::array<V, kLanes>, V>;
template <class V>
inline const V& OfLane(const V& value, int) {
  return value;
}
template <class V>
inline const V& OfLane(const std::array<V, kLanes>& values, int lane) {
  return values[static_cast<std::size_t>(lane)];
}

/// Result of a comparison of two T: Mask<double> is bool, and Mask<Pack> has one truth value per
/// lane.
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
/// An angle within +-20 pi with the same sine and cosine. xsimd reduces all lanes by the method
/// that the largest of them needs, and above 20 pi the last digit of a lane then depends on the
/// others.
inline Pack NearAngle(const Pack& a) {
  constexpr double kMost = 62.0, kTurn = 6.283185307179586;
  // Parts of 2 pi: the first one has 20 free digits, so its product with a count is exact.
  constexpr double kHigh = 6.2831853069365025, kLow = kTurn - kHigh, kRest = 2.4492935982947064e-16;
  const Pack turns = xsimd::nearbyint(a * (1.0 / kTurn));
  const Pack near = ((a - turns * kHigh) - turns * kLow) - turns * kRest;
  return xsimd::select(xsimd::abs(a) > kMost, xsimd::clip(near, Pack(-kMost), Pack(kMost)), a);
}
inline void SinCos(const Pack& a, Pack* s, Pack* c) {
  const auto sc = xsimd::sincos(NearAngle(a));
  *s = sc.first;
  *c = sc.second;
}
inline void SinCos(double a, double* s, double* c) {
  Pack ps, pc;
  SinCos(Pack(a), &ps, &pc);
  *s = ps.get(0);
  *c = pc.get(0);
}

/// Nearest number with float32's 24-bit significand, by Veltkamp's splitting. Two casts would not
/// work: GCC 12 at -O3 removes a vectorised double-float-double round trip. Exact in float32's
/// normal range; no other numbers are used.
template <class T>
inline T RoundToFloat(const T& a) {
  const T c = a * T(536870913.0);  // 2^29 + 1
  return c - (c - a);
}

/// Value of one lane; a double has the same value in every lane.
inline double Lane(double a, int) { return a; }
// Reads one lane from memory; Pack::get would copy the whole pack first.
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

}  // namespace stg

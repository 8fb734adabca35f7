#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace stg::agent {

/// Equally spaced codes of a number within [lo, hi].
struct Quantiser {
  double lo = 0.0, hi = 1.0, middle = 0.5;
  double resolution = 1.0, inverse = 1.0;
  double steps = 1.0;  ///< largest code

  /// Symmetric: an even number of steps, so that zero is exact; one code is left over.
  static Quantiser Signed(double limit, int bits) {
    Quantiser q;
    q.steps = static_cast<double>((1 << bits) - 2);
    q.resolution = 2.0 * limit / q.steps;
    q.lo = -limit;
    q.hi = limit;
    q.middle = 0.0;
    q.inverse = 1.0 / q.resolution;
    return q;
  }
  static Quantiser Unsigned(double lo, double hi, int bits) {
    Quantiser q;
    q.steps = static_cast<double>((1 << bits) - 1);
    q.resolution = (hi - lo) / q.steps;
    q.lo = lo;
    q.hi = hi;
    q.middle = 0.5 * (lo + hi);
    q.inverse = 1.0 / q.resolution;
    return q;
  }
};

/// Code of the nearest value; sets `saturated` when the value had to be clipped.
[[gnu::always_inline]] inline std::uint64_t Code(const Quantiser& q, double value,
                                                 bool* saturated) {
  const double code = std::floor((value - q.lo) * q.inverse + 0.5);
  const double clipped = std::min(std::max(code, 0.0), q.steps);
  *saturated |= clipped != code;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(clipped));
}

[[gnu::always_inline]] inline double Value(const Quantiser& q, std::uint64_t code,
                                           bool* unused_code) {
  const double c = static_cast<double>(static_cast<std::int64_t>(code));
  *unused_code |= c > q.steps;
  return std::min(std::max(q.middle + (c - 0.5 * q.steps) * q.resolution, q.lo), q.hi);
}

}  // namespace stg::agent

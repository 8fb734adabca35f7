#pragma once

#include <algorithm>
#include <cmath>

#include "auv_common/numbers/vector.hpp"
#include "stg_agent/entities/layout.hpp"

/// What all rows of entities need.
namespace stg::agent {

/// Writes numbers one after another, each clipped.
class Row {
 public:
  explicit Row(float* out) : out_(out) {}
  Row& Put(double value) {
    const auto x = static_cast<float>(value);
    *out_++ = std::min(std::max(x, -kEntityClip), kEntityClip);
    return *this;
  }
  const float* end() const { return out_; }

 private:
  float* out_;
};

/// The horizontal frame K.
struct Frame {
  double c = 1.0, s = 0.0;  // course

  double x(const Vec3<double>& v) const { return c * v.x + s * v.y; }
  double y(const Vec3<double>& v) const { return c * v.y - s * v.x; }
};

/// cos and sin of the bearing of a horizontal vector in K; straight ahead if the vector is zero.
inline void PutBearing(const Frame& K, const Vec3<double>& r, Row* row) {
  const double d = std::hypot(r.x, r.y);
  if (d < 1e-6) {
    row->Put(1.0).Put(0.0);
  } else {
    row->Put(K.x(r) / d).Put(K.y(r) / d);
  }
}

}  // namespace stg::agent

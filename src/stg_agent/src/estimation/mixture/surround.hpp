#pragma once

#include <algorithm>
#include <cmath>

#include "gaussian_mixture.hpp"

namespace stg::agent {

/// How evenly the observers of the last half minute surround the target of a mixture: one minus the
/// length of the mean of e^{2 i theta}, where theta is the bearing of an observer from the target.
/// 0: all are on one line through the target. Two on opposite sides also count as one line.
class Surround {
 public:
  /// @param dt_s time since the previous observer
  void LookFrom(const Vec3<double>& p_WO, double dt_s, const GaussianMixture& mixture) {
    double x = p_WO.x, y = p_WO.y;
    for (int k = 0; k < mixture.size(); ++k) {
      const Gaussian g = mixture.at(k);
      x -= g.x[0] * *g.weight;
      y -= g.x[1] * *g.weight;
    }
    const double square = std::max(x * x + y * y, 1e-6);
    const double kept = std::exp(-dt_s / kMemory_s);
    along_ = kept * along_ + (x * x - y * y) / square;
    across_ = kept * across_ + 2.0 * x * y / square;
    seen_ = kept * seen_ + 1.0;
  }
  double Share() const { return seen_ > 0.0 ? 1.0 - std::hypot(along_, across_) / seen_ : 0.0; }

 private:
  static constexpr double kMemory_s = 30.0;
  double along_ = 0.0, across_ = 0.0, seen_ = 0.0;
};

}  // namespace stg::agent

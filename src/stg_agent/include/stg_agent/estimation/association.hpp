#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "auv_common/numbers/assignment.hpp"
#include "auv_dynamics/measurements.hpp"
#include "stg_agent/estimation/joint_association.hpp"

/// Which detection is of which target, if detections do not say it (sensing.labelled).
namespace stg::agent {

/// How a detection fits the estimate of a target.
struct DetectionFit {
  bool started = false;  ///< there is an estimate
  /// Squared Mahalanobis distance of the innovation; of a mixture, the smallest one.
  double distance2 = std::numeric_limits<double>::infinity();
  /// Logarithm of how many times likelier it is to be of this target than to be false.
  double gain = -std::numeric_limits<double>::infinity();
};

/// 99 % quantile of chi-squared: the largest squared Mahalanobis distance at which a detection may
/// be of a target.
/// @param numbers measured numbers: 1, 2 or 3 degrees of freedom
constexpr double Gate(int numbers) {
  return numbers == 1 ? 6.634896601021214 : numbers == 2 ? 9.210340371976184 : 11.344866730144373;
}

inline bool InGate(const DetectionFit& fit, dynamics::MeasurementKind kind) {
  return fit.distance2 <= Gate(dynamics::NumbersOf(kind)) && fit.gain > 0.0;
}

/// Gives the detections of one look to targets (global nearest neighbour): at most one to each
/// target, with the largest sum of gains. A detection may remain without a target.
///
/// Where targets are close together, the choice may be wrong. So each comes with the odds of its
/// rivals, from the probabilities of all joint associations (JPDA; Fortmann, Bar-Shalom and Scheffe
/// 1983).
class LookAssignment {
 public:
  static constexpr int kMost = dynamics::kMostTargets;

  /// @param gain gain(detection, target); not positive: not allowed
  template <class Gain>
  void Solve(int detections, int targets, const Gain& gain) {
    // Each detection has a column of its own for no target.
    solver_.Solve(detections, targets + detections, [&](int row, int column) {
      if (column >= targets) return 0.0;
      const double g = gain(row, column);
      return g > 0.0 ? -g : kForbidden;
    });
    for (int row = 0; row < detections; ++row) {
      const int column = solver_.column_of(row);
      target_of_[At(row)] = column < targets && gain(row, column) > 0.0 ? column : -1;
    }
    for (int row = 0; row < detections; ++row) {
      for (int t = 0; t < targets; ++t) {
        const double g = gain(row, t);
        odds_[At(row)][At(t)] = g > 0.0 ? std::exp(g) : 0.0;
      }
    }
    for (int row = 0; row < detections; ++row) {
      const int t = target_of(row);
      rivals_[At(row)] = t < 0 ? 0.0 : RivalsOf(odds_, detections, targets, row, t);
    }
  }

  /// Target of a detection in the last solution; -1: none.
  int target_of(int detection) const { return target_of_[At(detection)]; }
  /// How many times likelier the detection is of another target than false, see RivalsOf.
  double rivals(int detection) const { return rivals_[At(detection)]; }

 private:
  static constexpr std::size_t At(int i) { return static_cast<std::size_t>(i); }

  static constexpr double kForbidden = 1e6;
  AssignmentSolver<kMost, 2 * kMost> solver_;
  std::array<int, kMost> target_of_{};
  std::array<double, kMost> rivals_{};
  LookOdds odds_{};
};

}  // namespace stg::agent

#pragma once

#include "auv_common/numbers/vector.hpp"

namespace stg::task {

/// An estimate that is farther than this from every target does not count as one of a target [m].
inline constexpr double kCutoff_m = 100.0;

/// Distances between two sets of positions, in the plane, of order 1 [m].
struct SetDistance {
  /// Optimal sub-pattern assignment (Schuhmacher, Vo and Vo 2008): mean, over the larger set, of
  /// the distances of the cheapest pairs. A distance above the cutoff, and a position without a
  /// pair, count as the cutoff. From 0 to the cutoff.
  double ospa_m = 0.0;
  /// Generalised OSPA with alpha = 2 (Rahmathullah, Garcia-Fernandez and Svensson 2017): the sum of
  /// the distances of the cheapest pairs, and half a cutoff for each missed and each false target;
  /// a pair farther apart than the cutoff is one missed and one false target.
  double gospa_m = 0.0;
};

/// @param a, b positions, at most 16 in each set
SetDistance DistanceOfSets(const Vec3<double>* a, int count_a, const Vec3<double>* b, int count_b,
                           double cutoff_m);

}  // namespace stg::task

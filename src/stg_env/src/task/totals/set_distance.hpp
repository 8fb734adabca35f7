#pragma once

#include "auv_common/numbers/vector.hpp"

namespace stg::task {

/// How far two sets of positions are apart, in the plane, of order 1 [m].
struct SetDistance {
  /// Optimal sub-pattern assignment (Schuhmacher, Vo and Vo 2008): mean over the larger set of the
  /// distances of the cheapest pairs, none counting more than the cutoff, as each position counts
  /// that is left over. From 0 to the cutoff.
  double ospa_m = 0.0;
  /// Generalised OSPA with alpha = 2 (Rahmathullah, Garcia-Fernandez and Svensson 2017): the sum of
  /// the distances of the cheapest pairs, and half a cutoff for each target missed and each false
  /// one; a pair farther apart than the cutoff is one of either.
  double gospa_m = 0.0;
};

/// @param a, b positions, of each no more than 16
SetDistance DistanceOfSets(const Vec3<double>* a, int count_a, const Vec3<double>* b, int count_b,
                           double cutoff_m);

}  // namespace stg::task

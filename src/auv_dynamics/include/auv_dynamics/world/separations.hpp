#pragma once

#include <vector>

#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// Distances between the vehicles of one swarm.
class Separations {
 public:
  /// @param contact_m vehicles closer than this collide
  Separations(int vehicles, double contact_m);

  void Measure(const std::vector<VehicleState<Pack>>& vehicles);

  /// Between vehicles i and j when last measured [m].
  const Pack& distance(int i, int j) const { return distances_[static_cast<size_t>(i * n_ + j)]; }
  /// Pairs closer than the contact distance, and the smallest distance of any pair [m].
  const Pack& colliding_pairs() const { return colliding_pairs_; }
  const Pack& smallest() const { return smallest_; }

 private:
  int n_;
  double contact_m_;
  std::vector<Pack> distances_;  // [vehicles, vehicles], symmetric
  Pack colliding_pairs_ = Pack(0.0), smallest_ = Pack(0.0);
};

}  // namespace stg::dynamics

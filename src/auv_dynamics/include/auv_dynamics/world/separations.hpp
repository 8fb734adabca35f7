#pragma once

#include <cstddef>
#include <vector>

#include "auv_common/numbers/vector.hpp"

namespace stg::dynamics {

/// Distances between the vehicles of a swarm. T = double: one swarm. T = Pack: kLanes swarms.
template <class T>
class Separations {
 public:
  Separations() = default;
  /// @param contact_m centres closer than this are in contact: two radii
  Separations(int vehicles, double contact_m)
      : count_(static_cast<std::size_t>(vehicles)),
        contact_(contact_m),
        distances_(count_ * count_, T(0.0)) {}

  /// @param vehicles indexable, with a position p_WB [m] each
  template <class Vehicles>
  void Measure(const Vehicles& vehicles) {
    T colliding_pairs(0.0), smallest(1e9);
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t j = i + 1; j < count_; ++j) {
        const T d = Norm(vehicles[j].p_WB - vehicles[i].p_WB);
        distances_[i * count_ + j] = d;
        distances_[j * count_ + i] = d;
        colliding_pairs += Select(d < contact_, T(1.0), T(0.0));
        smallest = Min(smallest, d);
      }
    }
    colliding_pairs_ = colliding_pairs;
    smallest_ = smallest;
  }

  /// Distance between vehicles i and j [m].
  const T& distance(int i, int j) const {
    return distances_[static_cast<std::size_t>(i) * count_ + static_cast<std::size_t>(j)];
  }
  /// Pairs in contact.
  const T& colliding_pairs() const { return colliding_pairs_; }
  /// Smallest distance of any two [m]; 1e9 if there is only one vehicle.
  const T& smallest() const { return smallest_; }

 private:
  std::size_t count_ = 0;
  T contact_ = T(0.0);
  std::vector<T> distances_;  // [vehicles, vehicles], symmetric
  T colliding_pairs_ = T(0.0), smallest_ = T(1e9);
};

}  // namespace stg::dynamics

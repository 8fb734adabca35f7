#pragma once

#include <cstddef>
#include <memory>

#include "auv_common/numbers/vector.hpp"

namespace stg::agent {

/// One normal distribution over a state: position and velocity of the target, then a block of
/// errors for each observer. A view; the numbers lie in a GaussianMixture.
struct Gaussian {
  double* weight;
  double* x;  ///< [stride]; what is past the state's size is zero
  double* P;  ///< [stride, stride], symmetric
};

inline constexpr int kTargetStates = 6;

/// Weighted normal distributions over one state. Fixed capacity; allocates nothing after
/// construction, and a copy costs as much as there are components.
class GaussianMixture {
 public:
  /// @param states    size of the state
  /// @param capacity  most components
  GaussianMixture(int states, int capacity);
  GaussianMixture(const GaussianMixture& other);
  GaussianMixture& operator=(const GaussianMixture& other);

  int size() const { return size_; }
  int states() const { return states_; }
  int stride() const { return stride_; }
  int capacity() const { return capacity_; }
  bool full() const { return size_ == capacity_; }

  Gaussian at(int k) const {
    double* p = data_.get() + static_cast<std::size_t>(k) * step_;
    return {p, p + 1, p + 1 + stride_};
  }
  /// Forgets all components.
  void Clear() { size_ = 0; }
  /// A new component, all zero but a weight of one. Not when full.
  Gaussian Add();
  /// A copy of component k. Not when full.
  Gaussian Copy(int k);
  /// A copy of the first states of component k of another mixture. Not when full.
  void AddPart(const GaussianMixture& other, int k);
  void Remove(int k);  ///< the last one takes its place

  /// Scales the weights to a sum of one.
  void Normalise();
  /// Splits component k along a unit vector of quantities a x, with the column P a of it: three
  /// components of the same mean and covariance together. Needs room for two more.
  /// @param Pa      [stride], P a
  /// @param variance aᵀ P a, positive
  void Split(int k, const double* Pa, double variance);
  /// Drops what has next to no weight, merges what lies close together, and what is nearest until
  /// at most `most` are left. Keeps mean and covariance of what it merges.
  void Reduce(int most);

 private:
  void Merge(int into, int from);
  void MergeNearest();
  double Separation(int a, int b) const;

  int states_, stride_, capacity_;
  std::size_t step_;  // numbers of a component
  int size_ = 0;
  // Not filled before it is needed: most mixtures have one component most of the time, and memory
  // that was never touched costs nothing.
  std::unique_ptr<double[]> data_;
};

}  // namespace stg::agent

#pragma once

#include <cstddef>
#include <memory>
#include <new>

#include "auv_common/numbers/vector.hpp"

namespace stg::agent {

/// One normal distribution over a state: position and velocity of the target, then a block of
/// errors for each observer. It is a view; the numbers are in a GaussianMixture.
struct Gaussian {
  double* weight;
  double* x;  ///< [stride]; zero beyond the size of the state
  double* P;  ///< [stride, stride], symmetric
};

inline constexpr int kTargetStates = 6;
/// Weight, x and each row of P begin at full registers of this many numbers. A load across two
/// lines of the cache takes longer.
inline constexpr int kRegister = 4;
inline constexpr std::align_val_t kAlignment{kRegister * sizeof(double)};

/// Weighted normal distributions over one state. The capacity is fixed, and nothing is allocated
/// after construction. The state grows as far as it is used: the cost of a copy is proportional to
/// the number of components, and to the square of the size of the state.
class GaussianMixture {
 public:
  /// @param least     size of the state of an empty mixture
  /// @param most      largest size of the state
  /// @param capacity  most components
  GaussianMixture(int least, int most, int capacity);
  GaussianMixture(const GaussianMixture& other);
  GaussianMixture& operator=(const GaussianMixture& other);

  int size() const { return size_; }
  int states() const { return states_; }
  int stride() const { return stride_; }
  int capacity() const { return capacity_; }
  bool full() const { return size_ == capacity_; }

  Gaussian at(int k) const {
    double* p = data_.get() + static_cast<std::size_t>(k) * step_;
    return {p, p + kRegister, p + kRegister + stride_};
  }
  /// Forgets all components. The state is as small as at first.
  void Clear() {
    size_ = 0;
    Resize(least_);
  }
  /// Makes the state at least this large. The new states are zero.
  void Cover(int states);
  /// Adds a component with weight one and zeros. The mixture must not be full.
  Gaussian Add();
  /// Adds a copy of component k. The mixture must not be full.
  Gaussian Copy(int k);
  /// Adds a copy of the first states of component k of another mixture. It must not be full.
  void AddPart(const GaussianMixture& other, int k);
  void Remove(int k);  ///< the last component takes its place

  /// Scales the weights to a sum of one.
  void Normalise();
  /// Splits component k along a unit vector a of quantities, with the column P a. The three new
  /// components together have the same mean and covariance. Needs room for two more components.
  /// @param Pa      [stride], P a
  /// @param variance aᵀ P a, positive
  void Split(int k, const double* Pa, double variance);
  /// Drops components with negligible weight and merges close ones. Then merges the nearest ones
  /// until at most `most` are left. Merging keeps mean and covariance.
  void Reduce(int most);

 private:
  void Resize(int states);
  void Merge(int into, int from);
  void MergeNearest();
  double Separation(int a, int b) const;

  struct Free {
    void operator()(double* p) const { ::operator delete(p, kAlignment); }
  };

  int least_, most_, capacity_;
  int states_, stride_;
  std::size_t step_;  // numbers per component
  int size_ = 0;
  // Memory is only written when it is needed. Most mixtures have one component most of the time,
  // and untouched memory costs nothing.
  std::unique_ptr<double[], Free> data_;
};

}  // namespace stg::agent

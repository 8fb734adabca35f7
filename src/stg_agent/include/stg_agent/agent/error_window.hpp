#pragma once

#include <vector>

#include "auv_common/numbers/lanes.hpp"

namespace stg::agent {

/// How the running mean of the tracking error is taken; the first two differ in rounding only.
enum class ErrorMean {
  kAgent,   ///< as agents do: in the order of the ring
  kTruth,   ///< as the truth mode does: oldest first
  kRelease  ///< as the release does: without the error of the first decision, and the last one
            ///< twice
};

/// Running mean of the tracking error over the last decisions, lane by lane: lanes may be at
/// different decisions.
template <class T>
class ErrorWindow {
 public:
  explicit ErrorWindow(int length, ErrorMean mean = ErrorMean::kAgent)
      : mean_(mean), errors_(static_cast<std::size_t>(length), T(0.0)) {}

  void Reset(int lane) {
    for (T& e : errors_) SetLane(&e, lane, 0.0);
    SetLane(&next_, lane, 0.0);
    SetLane(&count_, lane, 0.0);
  }

  /// Adds the error of this decision; returns the mean over the window.
  T Add(const T& error) {
    if (mean_ != ErrorMean::kAgent) return AddInOrder(error);
    const T zero(0.0), one(1.0), length(static_cast<double>(errors_.size()));
    T sum(0.0), slot(0.0);
    for (T& e : errors_) {
      e = Select(slot == next_, error, e);
      sum += e;  // zero before the history begins
      slot += one;
    }
    next_ += one;
    next_ = Select(next_ < length, next_, zero);
    count_ = Min(count_ + one, length);
    return sum / count_;
  }

  /// Restores the lanes outside the mask from `before`.
  void KeepOthers(const Mask<T>& lanes, const ErrorWindow& before) {
    for (std::size_t k = 0; k < errors_.size(); ++k) {
      errors_[k] = Select(lanes, errors_[k], before.errors_[k]);
    }
    next_ = Select(lanes, next_, before.next_);
    count_ = Select(lanes, count_, before.count_);
  }

 private:
  /// Stores the errors from the oldest to the newest; zero before the history begins.
  T AddInOrder(const T& error) {
    const bool release = mean_ == ErrorMean::kRelease;
    const T one(1.0), length(static_cast<double>(errors_.size()));
    T sum(0.0);
    for (std::size_t k = 0; k + 1 < errors_.size(); ++k) {
      errors_[k] = errors_[k + 1];
      if (k > 0 || !release) sum += errors_[k];
    }
    errors_.back() = release ? Select(count_ > T(0.5), error, T(0.0)) : error;
    if (errors_.size() > 1 || !release) sum += errors_.back();
    if (release) sum += error;
    count_ = Min(count_ + one, length);
    return sum * (one / count_);
  }

  ErrorMean mean_;
  std::vector<T> errors_;  // a ring
  T next_ = T(0.0);        // where the next error goes
  T count_ = T(0.0);       // how many there are
};

}  // namespace stg::agent

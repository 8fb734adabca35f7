#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "auv_common/time.hpp"

namespace stg {

/// The steps of a run for a listener. Many steps are open at once, and they are taken in order of
/// time.
///
/// The messages of a step may come in any order, mixed with messages of its neighbours. The oldest
/// step is taken when it is complete. It is also taken when it has waited too long and the run has
/// come to a later step, which the caller reports by Reach(). No step of the run waits for a
/// listener. So, unlike StepBarrier, this class waits for all parties in each step: this delays its
/// output, but not the run. The steps wait at the same time, not one after the other.
///
/// Stamps from the future do no harm. No step is given up before the run has come to it. The wait
/// for a step begins no sooner than the last message about an earlier one. If there is no room, the
/// latest step is dropped. Stamps from the past are refused; so the caller must call Clear() if the
/// run has been started anew with earlier stamps.
///
/// Times `now_s` are wall time in seconds. The caller chooses the clock; it must not go back. This
/// class reads no clock. Not thread-safe.
/// @tparam Frame the data of a step; each is copied from a blank one.
template <class Frame>
class StepWindow {
 public:
  /// @param capacity largest number of open steps, at least 1.
  StepWindow(std::size_t capacity, Frame blank) : capacity_(capacity), blank_(std::move(blank)) {
    assert(capacity > 0);
  }

  /// The frame of a step; blank at the first message about it. It is valid until the next call of
  /// any other function. Null: this step or a later one has been taken already, or there is no
  /// room.
  Frame* At(TimeNs stamp, double now_s) {
    assert(std::isfinite(now_s));
    if (has_taken_ && stamp <= taken_) {
      ++late_;
      return nullptr;
    }
    auto found = steps_.find(stamp);
    if (found == steps_.end()) {
      if (steps_.size() >= capacity_ && !MakeRoom(stamp)) return nullptr;
      found = steps_.emplace(stamp, Step{blank_, now_s, now_s}).first;
    }
    found->second.heard_s = now_s;
    return &found->second.frame;
  }

  /// The frame of an open step, valid until the next call of At, Take or Clear. Null: the step is
  /// not open.
  const Frame* Open(TimeNs stamp) const {
    const auto found = steps_.find(stamp);
    return found == steps_.end() ? nullptr : &found->second.frame;
  }

  /// Reports that the run has come to the step at `stamp`. Call it only for trusted stamps.
  void Reach(TimeNs stamp) {
    reached_ = has_reached_ ? std::max(reached_, stamp) : stamp;
    has_reached_ = true;
  }

  /// Takes the oldest step if it is complete, or if it has waited for `patience_s` and the run has
  /// come to a later one. False: no step was taken.
  /// @param complete returns for a const Frame& whether all its data is there.
  template <class Complete>
  bool Take(double now_s, double patience_s, const Complete& complete, Frame* frame) {
    assert(std::isfinite(now_s));
    if (steps_.empty()) return false;
    const auto oldest = steps_.begin();
    Step& step = oldest->second;
    if (!complete(static_cast<const Frame&>(step.frame))) {
      const double waited_s = now_s - std::max(step.opened_s, heard_before_s_);
      if (!has_reached_ || oldest->first >= reached_ || waited_s <= patience_s) return false;
    }
    heard_before_s_ = std::max(heard_before_s_, step.heard_s);
    *frame = std::move(step.frame);
    taken_ = oldest->first;
    has_taken_ = true;
    steps_.erase(oldest);
    return true;
  }

  /// Forgets all steps and the last step taken, because the run has been started anew.
  void Clear() {
    steps_.clear();
    has_taken_ = has_reached_ = false;
  }

  std::size_t size() const { return steps_.size(); }  ///< open steps
  bool has_taken() const { return has_taken_; }
  TimeNs taken() const { return taken_; }       ///< stamp of the last step taken, if any
  std::uint64_t late() const { return late_; }  ///< messages about steps that were taken already
  /// Number of steps that found no room, or were dropped for others.
  std::uint64_t crowded() const { return crowded_; }

 private:
  static constexpr double kNever = -std::numeric_limits<double>::infinity();

  struct Step {
    Frame frame;
    double opened_s;  ///< time of the first message about it
    double heard_s;   ///< time of the last message about it
  };

  /// Drops the latest step, unless the new one is later still.
  bool MakeRoom(TimeNs stamp) {
    ++crowded_;
    const auto latest = std::prev(steps_.end());
    if (stamp > latest->first) return false;
    steps_.erase(latest);
    return true;
  }

  std::size_t capacity_;
  Frame blank_;
  std::map<TimeNs, Step> steps_;
  bool has_taken_ = false, has_reached_ = false;
  TimeNs taken_ = 0, reached_ = 0;
  double heard_before_s_ = kNever;  ///< time of the last message about a step before it was taken
  std::uint64_t late_ = 0, crowded_ = 0;
};

}  // namespace stg

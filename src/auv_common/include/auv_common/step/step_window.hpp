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

/// Steps as a listener sees them: many are open at once, and are taken in order of time.
///
/// The messages of a step may come in any order, mixed with those of its neighbours. The oldest
/// step is taken when it is complete, or given up when patience with it is over and the run has
/// come to a later one, as Reach() says. No step waits for a listener, so unlike a StepBarrier it
/// waits for all parties in each step: that delays its output, not the steps. Patience with the
/// steps runs side by side.
///
/// Stamps from the future do no harm: no step is given up before the run has come to it, patience
/// with it begins no sooner than the last word about an earlier one, and where there is no room,
/// the latest step goes. Stamps from the past are refused: that a run has been started anew, with
/// stamps that were there before, must be said by Clear().
///
/// Times `now_s` are wall time in seconds of a clock of the caller's choice that does not go back.
/// This class reads no clock. Not thread-safe.
/// @tparam Frame what is known of a step; copied from a blank one.
template <class Frame>
class StepWindow {
 public:
  /// @param capacity steps that may be open at once, at least 1.
  StepWindow(std::size_t capacity, Frame blank) : capacity_(capacity), blank_(std::move(blank)) {
    assert(capacity > 0);
  }

  /// The frame of a step, blank if it is the first word about it; valid until the next call of any
  /// other function. Null: the step has been taken already, or a later one has, or there is no
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

  /// The frame of a step that is open, valid until the next call of At, Take or Clear. Null: it is
  /// not open.
  const Frame* Open(TimeNs stamp) const {
    const auto found = steps_.find(stamp);
    return found == steps_.end() ? nullptr : &found->second.frame;
  }

  /// The run has come to the step at `stamp`: to be said of what is trusted alone.
  void Reach(TimeNs stamp) {
    reached_ = has_reached_ ? std::max(reached_, stamp) : stamp;
    has_reached_ = true;
  }

  /// Takes the oldest step if it is complete, or if it has waited for `patience_s` and the run has
  /// come to a later one. False: wait.
  /// @param complete tells of a const Frame& whether all of it is there.
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

  /// Forgets all steps, and which were taken: the run has been started anew.
  void Clear() {
    steps_.clear();
    has_taken_ = has_reached_ = false;
  }

  std::size_t size() const { return steps_.size(); }  ///< open steps
  bool has_taken() const { return has_taken_; }
  TimeNs taken() const { return taken_; }             ///< stamp of the last step taken, if any
  std::uint64_t late() const { return late_; }        ///< words about steps that were over
  std::uint64_t crowded() const { return crowded_; }  ///< steps without room, or put out for others

 private:
  static constexpr double kNever = -std::numeric_limits<double>::infinity();

  struct Step {
    Frame frame;
    double opened_s;  ///< when the first word about it came
    double heard_s;   ///< when the last one did
  };

  /// Puts the latest step out, unless the new one would be later still.
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
  double heard_before_s_ = kNever;  ///< the last word about a step before it was taken
  std::uint64_t late_ = 0, crowded_ = 0;
};

}  // namespace stg

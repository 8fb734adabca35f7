#pragma once

#include <optional>
#include <vector>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

/// The channel for vehicles of anybody: their motion and packets as they come in, in whatever
/// order.
namespace stg::acoustics {

/// Where a vehicle is and how it moves, world axes.
struct Motion {
  Vec3<double> p_W{0.0, 0.0, 0.0};  ///< [m]
  Vec3<double> v_W{0.0, 0.0, 0.0};  ///< [m/s]
};

/// The motion of one vehicle between and beyond the moments at which it reported it.
///
/// Stamps may jitter, be rounded, repeat, or come out of order. Between two samples no more than
/// `patience` apart, position and velocity are interpolated linearly. Otherwise the position goes
/// on from the earlier one with its velocity: what comes too late to be waited for changes nothing.
/// A vehicle is silent from `silent_after` past a sample until the next, and not there before the
/// first: its motion is then nothing.
class MotionTrack {
 public:
  struct Limits {
    TimeNs patience = 0, silent_after = 0;
    /// False: velocities of the samples say nothing, differences of their positions count instead.
    bool has_velocity = true;
  };
  explicit MotionTrack(const Limits& limits);

  /// A sample at any time, with finite numbers. False: there is one of that time, which counts.
  bool Add(TimeNs t, const Motion& motion);

  /// Nothing: not there, or silent.
  std::optional<Motion> At(TimeNs t) const;

  /// Time of the newest sample, and of the newest up to and including t; nothing: there is none.
  std::optional<TimeNs> newest() const;
  std::optional<TimeNs> NewestUntil(TimeNs t) const;
  /// Times before t are not asked for again.
  void ForgetBefore(TimeNs t);
  void Clear() { samples_.clear(); }

 private:
  struct Sample {
    TimeNs t;
    Motion motion;
  };
  using Samples = std::vector<Sample>;
  Samples::const_iterator FirstAfter(TimeNs t) const;
  Motion Between(const Sample& a, const Sample& b, TimeNs t) const;
  Motion Beyond(Samples::const_iterator last, TimeNs t) const;

  Limits limits_;
  Samples samples_;  ///< in order of time
};

}  // namespace stg::acoustics

#pragma once

#include <optional>
#include <vector>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

/// The channel for vehicles of any software: their motion and packets may come in any order.
namespace stg::acoustics {

/// Position and velocity of a vehicle, world axes.
struct Motion {
  Vec3<double> p_W{0.0, 0.0, 0.0};  ///< [m]
  Vec3<double> v_W{0.0, 0.0, 0.0};  ///< [m/s]
};

/// The motion of one vehicle between and after its samples.
///
/// Stamps may jitter, be rounded, repeat, or come out of order. Between two samples no more than
/// `patience` apart, position and velocity are interpolated linearly. Otherwise the position
/// continues from the earlier sample with its velocity, so that a sample that comes too late has no
/// effect. A vehicle is silent from `silent_after` after a sample until the next one, and absent
/// before the first one; its motion is then empty.
class MotionTrack {
 public:
  struct Options {
    TimeNs patience = 0, silent_after = 0;
    /// False: ignore the velocities of the samples, and use differences of their positions.
    bool has_velocity = true;
  };
  explicit MotionTrack(const Options& options);

  /// Adds a sample at any time, with finite numbers. False: there is one of that time already,
  /// which is kept.
  bool Add(TimeNs t, const Motion& motion);

  /// Empty: absent or silent.
  std::optional<Motion> At(TimeNs t) const;

  /// Time of the newest sample, and of the newest one up to and including t; empty: there is none.
  std::optional<TimeNs> newest() const;
  std::optional<TimeNs> NewestUntil(TimeNs t) const;
  /// Drops samples that are not needed for times from t on.
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

  Options options_;
  Samples samples_;  ///< in order of time
};

}  // namespace stg::acoustics

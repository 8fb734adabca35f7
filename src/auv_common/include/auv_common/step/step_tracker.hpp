#pragma once

#include <cstdint>

#include "auv_common/time.hpp"

namespace stg {

/// The place in a run that a message states for itself.
struct RunPlace {
  std::uint64_t run = 0;  ///< random number, drawn when a run starts
  std::uint32_t episode = 0, step = 0;
  TimeNs stamp = 0;  ///< simulated time of the step
};

/// Follows a run by the places that its messages state, and refuses places that contradict the run.
///
/// In a run, time and episodes never go back, and all steps of an episode are one period apart.
/// Step 0 of the next episode follows the last step of an episode, or an earlier step if a reset
/// has cut the episode short. A place that contradicts this is refused, however near or far its
/// stamp is. A new run is never inferred from stamps; it has another run number.
///
/// A wrong message may contradict nothing, e.g. a future episode with a future stamp, and mislead
/// the tracker. The tracker then recovers: it accepts kPatience refused places that follow each
/// other as the start of another run. Not thread-safe; reads no clock.
class StepTracker {
 public:
  /// No run has later stamps [ns]: 2^31 s less a day. ROS has 32 bits with sign for the seconds of
  /// a difference of stamps.
  static constexpr TimeNs kLatest = (2'147'483'648 - 86'400) * 1'000'000'000;
  /// So many places in a row replace the known one.
  static constexpr int kPatience = 3;

  enum class Verdict {
    kRepeated,    ///< the known place
    kNext,        ///< a later step of the known episode
    kNewEpisode,  ///< a later episode of the same run
    kNewRun,      ///< another run, or the first place
    kRefused,     ///< it contradicts the run
  };

  /// @param period of steps, > 0 [ns]. @param episode_steps number of the last step of an episode,
  /// >= 0.
  StepTracker(TimeNs period, int episode_steps);

  /// Judges a place. A place that is not refused becomes the known one.
  Verdict Hear(const RunPlace& place);

  bool started() const { return started_; }
  /// The last accepted place; meaningless before there is one.
  const RunPlace& place() const { return place_; }
  /// Time of step 0 of the known episode.
  TimeNs start() const { return StartOf(place_); }

 private:
  TimeNs StartOf(const RunPlace& p) const {
    return p.stamp - static_cast<TimeNs>(p.step) * period_;
  }
  bool Possible(const RunPlace& place) const;
  /// True if `later` may come after `earlier` in one run.
  bool Follows(const RunPlace& earlier, const RunPlace& later) const;

  TimeNs period_;
  std::uint32_t episode_steps_;
  bool started_ = false;
  RunPlace place_;
  RunPlace doubted_;  ///< the last refused place
  int doubts_ = 0;    ///< number of refused places in a row that follow each other
};

}  // namespace stg

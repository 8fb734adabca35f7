#pragma once

#include <cstdint>

#include "auv_common/time.hpp"

namespace stg {

/// Where in a run a message says that it is.
struct RunPlace {
  std::uint64_t run = 0;  ///< drawn anew when a run starts
  std::uint32_t episode = 0, step = 0;
  TimeNs stamp = 0;  ///< of the step
};

/// Follows a run by what its messages say of themselves, and refuses what cannot be true of it.
///
/// In a run, time and episodes never go back, and all steps of an episode are a period apart. Step
/// 0 of the next episode follows the last step of the one before, or an earlier one that a reset
/// has cut short. What contradicts this is refused, however near or far its stamp is. That a run
/// has been started anew is never guessed from its stamps: it comes with another run number.
///
/// A tracker misled by a message that contradicts nothing, say a future episode in the future,
/// finds its way back: kPatience refused places that follow each other are believed, as the start
/// of another run. Not thread-safe; reads no clock.
class StepTracker {
 public:
  /// Later stamps are no time of any run [ns]: 2^31 s less a day. Where stamps are subtracted, ROS
  /// has 32 bits for the seconds and a sign.
  static constexpr TimeNs kLatest = (2'147'483'648 - 86'400) * 1'000'000'000;
  /// Places in a row that overrule what was known.
  static constexpr int kPatience = 3;

  enum class Verdict {
    kRepeated,    ///< the place that is known
    kNext,        ///< a later step of the same episode
    kNewEpisode,  ///< a later episode of the same run
    kNewRun,      ///< another run, or the first place of all
    kRefused,     ///< contradicts the run
  };

  /// @param period of steps, > 0 [ns]. @param episode_steps of the last place of an episode, >= 0.
  StepTracker(TimeNs period, int episode_steps);

  /// Judges a place; unless it is refused, it is the known one from now on.
  Verdict Hear(const RunPlace& place);

  bool started() const { return started_; }
  /// The last place that was not refused; meaningless before there is one.
  const RunPlace& place() const { return place_; }
  /// Time of step 0 of its episode.
  TimeNs start() const { return StartOf(place_); }

 private:
  TimeNs StartOf(const RunPlace& p) const {
    return p.stamp - static_cast<TimeNs>(p.step) * period_;
  }
  bool Possible(const RunPlace& place) const;
  /// `later` may come after `earlier` in one run.
  bool Follows(const RunPlace& earlier, const RunPlace& later) const;

  TimeNs period_;
  std::uint32_t episode_steps_;
  bool started_ = false;
  RunPlace place_;
  RunPlace doubted_;  ///< the last refused one
  int doubts_ = 0;    ///< refused places that follow each other
};

}  // namespace stg

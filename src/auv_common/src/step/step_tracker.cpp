#include "auv_common/step/step_tracker.hpp"

#include <cassert>

namespace stg {

StepTracker::StepTracker(TimeNs period, int episode_steps)
    : period_(period), episode_steps_(static_cast<std::uint32_t>(episode_steps)) {
  assert(period > 0 && episode_steps >= 0);
}

StepTracker::Verdict StepTracker::Hear(const RunPlace& place) {
  if (!Possible(place)) return Verdict::kRefused;
  Verdict verdict = Verdict::kNewRun;
  if (started_ && place.run == place_.run) {
    const bool here = place.episode == place_.episode && StartOf(place) == start();
    if (here && place.step == place_.step) {
      verdict = Verdict::kRepeated;
    } else if (Follows(place_, place)) {
      verdict = here ? Verdict::kNext : Verdict::kNewEpisode;
    } else {
      doubts_ = doubts_ > 0 && Follows(doubted_, place) ? doubts_ + 1 : 1;
      doubted_ = place;
      if (doubts_ < kPatience) return Verdict::kRefused;
    }
  }
  doubts_ = 0;
  started_ = true;
  place_ = place;
  return verdict;
}

bool StepTracker::Possible(const RunPlace& place) const {
  return place.step <= episode_steps_ && place.stamp <= kLatest &&
         static_cast<double>(place.stamp) >=
             static_cast<double>(place.step) * static_cast<double>(period_);
}

bool StepTracker::Follows(const RunPlace& earlier, const RunPlace& later) const {
  if (later.run != earlier.run || later.episode < earlier.episode) return false;
  const TimeNs start = StartOf(earlier), next_start = StartOf(later);
  if (later.episode == earlier.episode) return next_start == start && later.step > earlier.step;
  // A double, because the product may exceed 64 bits. It holds the numbers of real runs exactly.
  const double longest = (static_cast<double>(later.episode) - earlier.episode) *
                         (static_cast<double>(episode_steps_) + 1.0) * static_cast<double>(period_);
  return next_start >= earlier.stamp + period_ &&
         static_cast<double>(next_start - start) <= longest;
}

}  // namespace stg

#include "auv_common/step/step_tracker.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stg {
namespace {

using Verdict = StepTracker::Verdict;

constexpr TimeNs kSecond = 1'000'000'000;
constexpr TimeNs kPeriod = kSecond / 10;
constexpr int kSteps = 40;
constexpr std::uint64_t kRun = 7;

/// Place of a run. Its first step is at 1 s, and each of its episodes is complete.
RunPlace At(std::uint32_t episode, std::uint32_t step, std::uint64_t run = kRun) {
  return {run, episode, step,
          kSecond + (static_cast<TimeNs>(episode) * (kSteps + 1) + step) * kPeriod};
}

RunPlace Later(RunPlace place, TimeNs by) {
  place.stamp += by;
  return place;
}

class StepTrackerTest : public testing::Test {
 protected:
  StepTracker tracker_{kPeriod, kSteps};
};

TEST_F(StepTrackerTest, FollowsARunStepByStepThroughItsEpisodes) {
  EXPECT_FALSE(tracker_.started());
  for (std::uint32_t episode = 0; episode < 3; ++episode) {
    for (std::uint32_t step = 0; step <= kSteps; ++step) {
      const Verdict expected = step > 0      ? Verdict::kNext
                               : episode > 0 ? Verdict::kNewEpisode
                                             : Verdict::kNewRun;
      ASSERT_EQ(tracker_.Hear(At(episode, step)), expected) << episode << " " << step;
      ASSERT_EQ(tracker_.Hear(At(episode, step)), Verdict::kRepeated);
      ASSERT_EQ(tracker_.start(), At(episode, 0).stamp);
    }
  }
}

TEST_F(StepTrackerTest, MissedStepsAndEpisodesAreNoContradiction) {
  tracker_.Hear(At(0, 3));
  EXPECT_EQ(tracker_.Hear(At(0, 30)), Verdict::kNext);
  EXPECT_EQ(tracker_.Hear(At(1000, 5)), Verdict::kNewEpisode);
}

TEST_F(StepTrackerTest, AResetStartsTheNextEpisodeEarly) {
  tracker_.Hear(At(0, 3));
  EXPECT_EQ(tracker_.Hear({kRun, 1, 0, At(0, 4).stamp}), Verdict::kNewEpisode);
}

TEST_F(StepTrackerTest, RefusesAnyStampThatTheStepNumberContradicts) {
  tracker_.Hear(At(2, 10));
  for (const TimeNs by : {-58 * kSecond, -kPeriod, TimeNs{-1}, TimeNs{1}, kPeriod, 58 * kSecond,
                          2'147'483'647 * kSecond, 4'294'967'295 * kSecond}) {
    // The tracker hears it twice, because the second one must not confirm the first one.
    EXPECT_EQ(tracker_.Hear(Later(At(2, 11), by)), Verdict::kRefused) << by;
    EXPECT_EQ(tracker_.Hear(Later(At(2, 11), by)), Verdict::kRefused) << by;
  }
  EXPECT_EQ(tracker_.Hear(At(2, 11)), Verdict::kNext);
}

TEST_F(StepTrackerTest, RefusesThePastAndWhatNoRunCanReach) {
  tracker_.Hear(At(2, 10));
  EXPECT_EQ(tracker_.Hear(At(2, 9)), Verdict::kRefused);
  EXPECT_EQ(tracker_.Hear(At(1, 40)), Verdict::kRefused);
  EXPECT_EQ(tracker_.Hear(Later(At(3, 0), kPeriod)), Verdict::kRefused)
      << "an episode is no longer than it is";
  EXPECT_EQ(tracker_.Hear({kRun, 3, 0, At(2, 10).stamp}), Verdict::kRefused)
      << "an episode begins after the one before";
  EXPECT_EQ(tracker_.Hear({kRun, 2, kSteps + 1, At(2, 0).stamp + (kSteps + 1) * kPeriod}),
            Verdict::kRefused)
      << "a step past the end";
  EXPECT_EQ(tracker_.place().step, 10U);
}

TEST_F(StepTrackerTest, NoNumbersOverflow) {
  const std::uint32_t most = 4'294'967'295;
  tracker_.Hear({kRun, 0, 0, 0});
  EXPECT_EQ(tracker_.Hear({kRun, most, kSteps, StepTracker::kLatest}), Verdict::kNewEpisode);
  EXPECT_EQ(tracker_.Hear({kRun + 1, 0, 0, StepTracker::kLatest + 1}), Verdict::kRefused);
  StepTracker endless(3600 * kSecond, 2'000'000'000);
  EXPECT_EQ(endless.Hear({kRun, 0, 2'000'000'000, StepTracker::kLatest}), Verdict::kRefused)
      << "began before time did";
  EXPECT_EQ(endless.Hear({kRun, 0, 0, 0}), Verdict::kNewRun);
  EXPECT_EQ(endless.Hear({kRun, most, 0, StepTracker::kLatest}), Verdict::kNewEpisode);
}

TEST_F(StepTrackerTest, ANewRunIsBelievedAtOnceWhereverItsClockIs) {
  tracker_.Hear(At(5, 30));
  EXPECT_EQ(tracker_.Hear(At(0, 0, kRun + 1)), Verdict::kNewRun);
  EXPECT_EQ(tracker_.Hear(At(0, 1, kRun + 1)), Verdict::kNext);
}

TEST_F(StepTrackerTest, OneThatWasMisledFindsItsWayBack) {
  tracker_.Hear(At(0, 10));
  ASSERT_EQ(tracker_.Hear(At(900, 0)), Verdict::kNewEpisode);  // nothing contradicts it
  std::vector<Verdict> heard;
  for (std::uint32_t step = 11; step < 15; ++step) heard.push_back(tracker_.Hear(At(0, step)));
  EXPECT_EQ(heard, (std::vector<Verdict>{Verdict::kRefused, Verdict::kRefused, Verdict::kNewRun,
                                         Verdict::kNext}));
}

TEST_F(StepTrackerTest, RefusedOnesThatComeBetweenTheTrueOnesNeverPrevail) {
  tracker_.Hear(At(0, 0));
  for (std::uint32_t step = 1; step <= kSteps; ++step) {
    ASSERT_EQ(tracker_.Hear(Later(At(0, step), 58 * kSecond)), Verdict::kRefused);
    ASSERT_EQ(tracker_.Hear(At(0, step)), Verdict::kNext);
  }
}

}  // namespace
}  // namespace stg

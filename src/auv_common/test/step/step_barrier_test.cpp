#include "auv_common/step/step_barrier.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "step_barrier_fixture.hpp"

namespace stg::step_barrier_test {

TEST(StepBarrier, IsCompleteWhenTheLastPartyHasAnswered) {
  StepBarrier barrier(3);
  EXPECT_FALSE(barrier.Complete()) << "no step is open";
  EXPECT_EQ(barrier.Open(kFirst, 5.0), Opening::kOpened);
  HearAll(&barrier, {1, 0});
  EXPECT_FALSE(barrier.Complete());
  EXPECT_TRUE(barrier.Complete(0, 2)) << "of a part of the parties";
  EXPECT_FALSE(barrier.Complete(2, 3));
  HearAll(&barrier, {2});
  EXPECT_TRUE(barrier.Complete());
  EXPECT_EQ(barrier.deadline_s(), kForever);
  barrier.Close();
  EXPECT_FALSE(barrier.Complete());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(barrier.misses(i), 0u);
}

TEST(StepBarrier, AnAnswerCountsOnce) {
  StepBarrier barrier(2);
  barrier.Open(kFirst, 5.0);
  EXPECT_EQ(barrier.Hear(0, kFirst), Word::kCounts);
  EXPECT_EQ(barrier.Hear(0, kFirst), Word::kDuplicate);
  EXPECT_FALSE(barrier.Complete()) << "two answers of one party are not those of two";
  HearAll(&barrier, {1});
  barrier.Close();
  EXPECT_EQ(barrier.Hear(0, kFirst), Word::kDuplicate);
}

TEST(StepBarrier, GivesUpTheSilentAtTheirDeadlineAndNotBefore) {
  StepBarrier barrier(3);
  barrier.Open(kFirst, 5.0);
  HearAll(&barrier, {1});
  EXPECT_EQ(barrier.deadline_s(), 5.0);
  EXPECT_EQ(barrier.GiveUp(4.999), Parties{});
  EXPECT_FALSE(barrier.Complete());
  EXPECT_EQ(barrier.GiveUp(5.0), (Parties{0, 2}));
  EXPECT_TRUE(barrier.Complete());
  EXPECT_EQ(barrier.GiveUp(6.0), Parties{}) << "given up once";
  EXPECT_FALSE(barrier.present(0));
  EXPECT_TRUE(barrier.present(1));
  EXPECT_FALSE(barrier.answered(0));
  barrier.Close();
  EXPECT_EQ(barrier.misses(0), 1u);
  EXPECT_EQ(barrier.misses(1), 0u);
}

TEST(StepBarrier, WhoIsAbsentIsNotWaitedForAndMissesEachStep) {
  StepBarrier barrier(2);
  barrier.Open(kFirst, 5.0);
  HearAll(&barrier, {1});
  barrier.GiveUp(5.0);
  barrier.Close();
  for (int k = 1; k <= 4; ++k) {
    barrier.Open(kFirst + k * kStep, 5.0 + k);
    EXPECT_FALSE(barrier.Complete());
    HearAll(&barrier, {1});
    EXPECT_TRUE(barrier.Complete());
    barrier.Close();
  }
  EXPECT_EQ(barrier.misses(0), 5u);
  EXPECT_EQ(barrier.losses(0), 1u);
  EXPECT_EQ(barrier.losses(1), 0u);
}

TEST(StepBarrier, WithNobodyPresentStepsAreCompleteAtOnce) {
  StepBarrier nobody(0);
  nobody.Open(kFirst, 5.0);
  EXPECT_TRUE(nobody.Complete());
  EXPECT_EQ(nobody.GiveUp(5.0), Parties{});
  StepBarrier barrier(2);
  barrier.Open(kFirst, 5.0);
  EXPECT_EQ(barrier.GiveUp(5.0), (Parties{0, 1}));
  barrier.Close();
  barrier.Open(kFirst + kStep, 6.0);
  EXPECT_TRUE(barrier.Complete());
}

TEST(StepBarrier, AnAbsentPartyThatAnswersIsBack) {
  StepBarrier barrier(1);
  barrier.Open(kFirst, 5.0);
  barrier.GiveUp(5.0);
  EXPECT_EQ(barrier.Hear(0, kFirst), Word::kCounts) << "late for its deadline, not for the step";
  barrier.Close();
  EXPECT_EQ(barrier.misses(0), 0u);
  barrier.Open(kFirst + kStep, 6.0);
  EXPECT_FALSE(barrier.Complete()) << "waited for again";
}

TEST(StepBarrier, ALateAnswerBringsAPartyBackButDoesNotCount) {
  StepBarrier barrier(1);
  barrier.Open(kFirst, 5.0);
  barrier.GiveUp(5.0);
  barrier.Close();
  EXPECT_EQ(barrier.Hear(0, kFirst), Word::kLate) << "the step is closed";
  EXPECT_TRUE(barrier.present(0));
  EXPECT_FALSE(barrier.answered(0));

  barrier.Open(kFirst + kStep, 6.0);
  barrier.GiveUp(6.0);
  EXPECT_FALSE(barrier.present(0));
  EXPECT_EQ(barrier.Hear(0, kFirst), Word::kLate) << "about an earlier step";
  EXPECT_TRUE(barrier.present(0));
  EXPECT_FALSE(barrier.Complete());
  barrier.Close();
  EXPECT_EQ(barrier.misses(0), 2u);
}

TEST(StepBarrier, AnEarlyAnswerIsForTheCallerToKeep) {
  StepBarrier barrier(1);
  EXPECT_EQ(barrier.Hear(0, kFirst), Word::kEarly) << "before the first step";
  barrier.Open(kFirst, 5.0);
  EXPECT_FALSE(barrier.Complete()) << "is not remembered";
  EXPECT_EQ(barrier.Hear(0, kFirst + kStep), Word::kEarly);
  EXPECT_FALSE(barrier.Complete());
  HearAll(&barrier, {0});
  EXPECT_EQ(barrier.Hear(0, kFirst + kStep), Word::kEarly);
  EXPECT_TRUE(barrier.answered(0)) << "of the open step";
  barrier.Close();
  EXPECT_EQ(barrier.Hear(0, kFirst + kStep), Word::kEarly);
  barrier.Open(kFirst + kStep, 6.0);
  EXPECT_EQ(barrier.Hear(0, kFirst + kStep), Word::kCounts);
}

TEST(StepBarrier, WordsAboutTwoStepsBeforeAndAheadAreOfTheRunHoweverLongStepsAre) {
  constexpr TimeNs kLong = StepBarrier::kRecent;
  for (const TimeNs period : {kStep, kLong / 2, kLong, 100 * kLong}) {
    StepBarrier barrier(1, period);
    const TimeNs now = kFirst + 10 * period;
    barrier.Open(now, 5.0);
    for (const int steps : {1, 2}) {
      EXPECT_EQ(barrier.Hear(0, now - steps * period), Word::kLate) << period;
      EXPECT_EQ(barrier.Hear(0, now + steps * period), Word::kEarly) << period;
    }
    EXPECT_EQ(barrier.Hear(0, now + 3 * std::max(period, kLong)), Word::kForeign) << period;
  }
}

TEST(StepBarrier, WordsOfAnotherTimeProveNothing) {
  StepBarrier barrier(1);
  const TimeNs now = kFirst + 2 * StepBarrier::kRecent;
  barrier.Open(now, 5.0);
  barrier.GiveUp(5.0);
  const TimeNs ends[] = {std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max(),
                         now - StepBarrier::kRecent, now + StepBarrier::kRecent};
  for (const TimeNs stamp : ends) {
    EXPECT_EQ(barrier.Hear(0, stamp), Word::kForeign) << stamp;
    EXPECT_FALSE(barrier.present(0)) << stamp;
  }
  EXPECT_EQ(barrier.Hear(0, now - StepBarrier::kRecent + 1), Word::kLate);
  EXPECT_TRUE(barrier.present(0));
  barrier.GiveUp(5.0);
  EXPECT_EQ(barrier.Hear(0, now + StepBarrier::kRecent - 1), Word::kEarly);
  EXPECT_TRUE(barrier.present(0));
}

TEST(StepBarrier, AnExcusedPartyIsNotWaitedForAndMissesNothing) {
  StepBarrier barrier(2);
  barrier.Open(kFirst, 5.0);
  barrier.GiveUp(5.0);
  barrier.Close();
  barrier.Hear(1, kFirst);
  barrier.Open(kFirst + kStep, 6.0);
  barrier.Excuse(0);
  barrier.Excuse(1);
  EXPECT_TRUE(barrier.Complete());
  EXPECT_EQ(barrier.GiveUp(6.0), Parties{});
  barrier.Close();
  EXPECT_EQ(barrier.misses(0), 1u);
  EXPECT_FALSE(barrier.present(0)) << "as before";
  EXPECT_TRUE(barrier.present(1)) << "as before";
  barrier.Open(kFirst + 2 * kStep, 7.0);
  EXPECT_FALSE(barrier.Complete()) << "for one step only";
  EXPECT_EQ(barrier.deadline_s(), 7.0) << "what was not asked owes nothing";
}

TEST(StepBarrier, WhoIsAskedNowAndThenOwesAnAnswerInBetween) {
  // The party is asked in every third step. Each step is closed before its patience has passed.
  StepBarrier barrier(1);
  for (int k = 0; k < 9; ++k) {
    const double now = 1.0 * k;
    barrier.Open(kFirst + k * kStep, now + 5.0);
    if (k % 3 != 0) barrier.Excuse(0);
    EXPECT_EQ(barrier.GiveUp(now), k == 6 ? Parties{0} : Parties{}) << "step " << k;
    barrier.Close();
  }
  EXPECT_EQ(barrier.losses(0), 1u);
  EXPECT_EQ(barrier.misses(0), 3u) << "of the steps that asked";
}

TEST(StepBarrier, ARepeatedOpeningChangesNothing) {
  StepBarrier barrier(2);
  barrier.Open(kFirst, 5.0);
  HearAll(&barrier, {0});
  EXPECT_EQ(barrier.Open(kFirst, 50.0), Opening::kRepeated);
  EXPECT_TRUE(barrier.answered(0));
  EXPECT_EQ(barrier.deadline_s(), 5.0);
  HearAll(&barrier, {1});
  barrier.Close();
  EXPECT_EQ(barrier.Open(kFirst, 50.0), Opening::kRepeated);
  EXPECT_FALSE(barrier.open());
}

TEST(StepBarrier, AStepThatIsReplacedIsMissedByNobodyAndPresenceIsKept) {
  StepBarrier barrier(2);
  barrier.Open(kFirst, 5.0);
  HearAll(&barrier, {1});
  barrier.GiveUp(5.0);
  EXPECT_EQ(barrier.Open(kFirst + kStep, 6.0), Opening::kReplaced);
  EXPECT_FALSE(barrier.present(0));
  EXPECT_TRUE(barrier.present(1));
  EXPECT_FALSE(barrier.answered(1)) << "its answer was to another step";
  EXPECT_FALSE(barrier.started());
  for (int i = 0; i < 2; ++i) EXPECT_EQ(barrier.misses(i), 0u);
}

TEST(StepBarrier, StampsMayGoBack) {
  StepBarrier barrier(2);
  const TimeNs high = kFirst + 1000 * kStep;
  barrier.Open(high, 5.0);
  HearAll(&barrier, {0});
  barrier.GiveUp(5.0);
  barrier.Close();
  EXPECT_EQ(barrier.Open(kFirst, 6.0), Opening::kOpened);
  EXPECT_FALSE(barrier.Complete());
  EXPECT_FALSE(barrier.present(1));
  EXPECT_EQ(barrier.Hear(0, high), Word::kForeign);
  EXPECT_FALSE(barrier.answered(0));
  HearAll(&barrier, {0});
  EXPECT_TRUE(barrier.Complete());
}

}  // namespace stg::step_barrier_test

#include "auv_common/step/step_barrier.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace stg {
namespace {

using Opening = StepBarrier::Opening;
using Word = StepBarrier::Word;
using Parties = std::vector<int>;

constexpr TimeNs kStep = 100'000'000;
constexpr TimeNs kFirst = 1'000'000'000;
constexpr double kForever = std::numeric_limits<double>::infinity();

void HearAll(StepBarrier* barrier, const Parties& parties) {
  for (const int i : parties) EXPECT_EQ(barrier->Hear(i, barrier->stamp()), Word::kCounts);
}

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
  // Asked in each third step; every step is left behind before patience with it ends.
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

TEST(StepBarrier, NewStepsDoNotRenewThePatienceWithTheSilent) {
  // Each step is open for 0.1 s before the world moves on, less than the patience of 0.25 s.
  StepBarrier barrier(3);
  int given_up_at = -1;
  for (int k = 0; k < 10; ++k) {
    const double now_s = 0.1 * k;
    if (k % 2 == 1 && barrier.open()) barrier.Close();  // whether closed or replaced
    barrier.Open(kFirst + k * kStep, now_s + 0.25);
    HearAll(&barrier, {1});
    barrier.Hear(2, kFirst + (k - 1) * kStep);  // always one step late, but alive
    const Parties given_up = barrier.GiveUp(now_s + 0.09);
    if (given_up.empty()) continue;
    EXPECT_EQ(given_up, Parties{0});
    EXPECT_EQ(given_up_at, -1) << "once";
    given_up_at = k;
  }
  EXPECT_EQ(given_up_at, 2) << "0.2 + 0.09 s after the first step";
  EXPECT_TRUE(barrier.present(1));
  EXPECT_TRUE(barrier.present(2));
}

TEST(StepBarrier, TheSilenceOfOneCostsNoPatienceWithOthers) {
  StepBarrier barrier(2);
  barrier.Open(kFirst, 1.0);
  HearAll(&barrier, {1});
  barrier.Open(kFirst + kStep, 1.9);
  EXPECT_EQ(barrier.deadline_s(), 1.0);
  EXPECT_EQ(barrier.GiveUp(1.0), Parties{0});
  EXPECT_FALSE(barrier.Complete());
  EXPECT_EQ(barrier.deadline_s(), 1.9);
  EXPECT_EQ(barrier.GiveUp(1.9), Parties{1});
}

TEST(StepBarrier, AWordAboutAnotherStepIsAnsweredWithThePatienceOfTheOpenOne) {
  StepBarrier barrier(1);
  barrier.Open(kFirst, 1.0);
  barrier.Open(kFirst + kStep, 2.0);
  EXPECT_EQ(barrier.deadline_s(), 1.0);
  EXPECT_EQ(barrier.Hear(0, kFirst), Word::kLate);
  EXPECT_EQ(barrier.deadline_s(), 2.0);
  barrier.GiveUp(2.0);
  barrier.Open(kFirst + 2 * kStep, 3.0);
  barrier.Hear(0, kFirst);
  EXPECT_EQ(barrier.deadline_s(), 3.0) << "of a party that is back, too";
}

TEST(StepBarrier, TheStartIsOverWhenAStepIsClosed) {
  // The caller waits longer for nodes that are only starting, for ever if need be.
  StepBarrier barrier(2);
  EXPECT_FALSE(barrier.started());
  barrier.Open(kFirst, kForever);
  HearAll(&barrier, {0});
  EXPECT_EQ(barrier.GiveUp(1e9), Parties{});
  EXPECT_FALSE(barrier.started());
  barrier.Close();  // the world has moved on
  EXPECT_TRUE(barrier.started());
  barrier.Open(kFirst + kStep, 2.0);
  EXPECT_EQ(barrier.GiveUp(2.0), (Parties{0, 1})) << "the patience of the start is over, too";
}

TEST(StepBarrier, APauseGivesEverybodyNewPatience) {
  StepBarrier barrier(2);
  barrier.Open(kFirst, 1.0);
  barrier.Open(kFirst + kStep, 2.0);
  barrier.Extend(100.5);
  EXPECT_EQ(barrier.deadline_s(), 100.5);
  EXPECT_EQ(barrier.GiveUp(100.0), Parties{});
  EXPECT_EQ(barrier.GiveUp(100.5), (Parties{0, 1}));
}

TEST(StepBarrier, AnotherRunBeginsWithEverybodyPresent) {
  StepBarrier barrier(2);
  barrier.Open(kFirst, 1.0);
  HearAll(&barrier, {1});
  barrier.GiveUp(1.0);
  barrier.Close();
  barrier.Open(kFirst + kStep, 2.0);
  barrier.Restart();
  EXPECT_FALSE(barrier.open());
  EXPECT_FALSE(barrier.started());
  EXPECT_EQ(barrier.Open(kFirst + kStep, 9.0), Opening::kOpened) << "the same stamp, another run";
  EXPECT_EQ(barrier.deadline_s(), 9.0);
  EXPECT_EQ(barrier.GiveUp(9.0), (Parties{0, 1}));
  EXPECT_EQ(barrier.misses(0), 1u) << "counters go on";
  barrier.Restart();
  EXPECT_EQ(barrier.Hear(1, kFirst + 1000 * kStep), Word::kEarly) << "there is no time to compare";
}

/// Steps of a swarm in which everybody answers, is late, silent or doubles at random.
TEST(StepBarrier, EveryStepEndsInTimeAndEveryStepOfEveryPartyIsAnsweredOrMissed) {
  constexpr int kParties = 5, kSteps = 2000;
  constexpr double kPatience_s = 1.0;
  std::mt19937 random(7);
  StepBarrier barrier(kParties);
  std::vector<std::uint64_t> answers(kParties, 0);
  double now_s = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const TimeNs stamp = kFirst + k * kStep;
    const double opened_s = now_s;
    barrier.Open(stamp, opened_s + kPatience_s);
    while (!barrier.Complete()) {
      ASSERT_LT(now_s, opened_s + kPatience_s + 0.1);
      now_s += 0.1;
      const int party = static_cast<int>(random() % kParties);
      const bool silent = random() % 3 == 0;
      const TimeNs about = random() % 4 == 0 ? stamp - kStep : stamp;
      if (!silent && barrier.Hear(party, about) == Word::kCounts) {
        ++answers[static_cast<std::size_t>(party)];
      }
      barrier.GiveUp(now_s);
    }
    barrier.Close();
  }
  std::uint64_t losses = 0;
  for (int i = 0; i < kParties; ++i) {
    EXPECT_EQ(answers[static_cast<std::size_t>(i)] + barrier.misses(i), std::uint64_t{kSteps});
    losses += barrier.losses(i);
  }
  EXPECT_GT(losses, 0u);
}

}  // namespace
}  // namespace stg

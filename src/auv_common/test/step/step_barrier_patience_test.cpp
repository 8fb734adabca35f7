#include <gtest/gtest.h>

#include <random>

#include "auv_common/step/step_barrier.hpp"
#include "step_barrier_fixture.hpp"

namespace stg::step_barrier_test {

TEST(StepBarrier, NewStepsDoNotRenewThePatienceWithTheSilent) {
  // Each step is open for 0.1 s, which is shorter than the patience of 0.25 s.
  StepBarrier barrier(3);
  int given_up_at = -1;
  for (int k = 0; k < 10; ++k) {
    const double now_s = 0.1 * k;
    // Every second step is closed, the others are replaced.
    if (k % 2 == 1 && barrier.open()) barrier.Close();
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
  // The caller waits longer for nodes that are still starting, for ever if necessary.
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

}  // namespace stg::step_barrier_test

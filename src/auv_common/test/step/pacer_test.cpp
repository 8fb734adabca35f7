#include "auv_common/step/pacer.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stg {
namespace {

constexpr double kNoVehicle = std::numeric_limits<double>::infinity();
constexpr double kStart_s = 1000.0;  // the value of the clock does not matter

/// The period of a step is 0.1 s, divided by the real time factor.
Pacer::Options OptionsOf(double real_time_factor) {
  Pacer::Options options;
  options.period_s = 0.1;
  options.real_time_factor = real_time_factor;
  options.deadline_s = 0.5;
  options.start_timeout_s = 30.0;
  return options;
}

/// A pacer whose first step was taken at kStart_s.
Pacer Running(double real_time_factor) {
  Pacer pacer(OptionsOf(real_time_factor));
  pacer.Open(kStart_s - 3.0);
  pacer.Begin(kStart_s);
  pacer.Open(kStart_s);
  return pacer;
}

TEST(Pacer, NothingIsDueBeforeTheRunBegins) {
  Pacer pacer(OptionsOf(1.0));
  EXPECT_FALSE(pacer.running());
  pacer.Open(kStart_s);
  EXPECT_EQ(pacer.deadline_s(), kStart_s + 30.0);
  EXPECT_FALSE(pacer.Due(kStart_s + 100.0));
  EXPECT_EQ(pacer.WaitTime(kStart_s, kStart_s + 30.0), Pacer::kIdleWait_s);
  pacer.Begin(kStart_s + 7.0);
  EXPECT_TRUE(pacer.running());
  EXPECT_TRUE(pacer.Due(kStart_s + 7.0)) << "the step that waited for the start";
}

TEST(Pacer, TheStartEndsHoweverOftenItsStepIsOpenedAnew) {
  Pacer pacer(OptionsOf(0.0));
  for (int k = 0; k < 100; ++k) pacer.Open(kStart_s + k);
  EXPECT_EQ(pacer.deadline_s(), kStart_s + 30.0);
}

TEST(Pacer, OnTheWallClockStepsAreDueEveryPeriodAndWaitedForUntilThen) {
  for (const double factor : {0.5, 1.0, 4.0}) {
    Pacer pacer = Running(factor);
    EXPECT_FALSE(pacer.lockstep());
    const double period_s = 0.1 / factor;
    for (int k = 1; k <= 50; ++k) {
      const double due_s = kStart_s + k * period_s;
      EXPECT_NEAR(pacer.due_s(), due_s, 1e-9);
      EXPECT_EQ(pacer.deadline_s(), pacer.due_s());
      EXPECT_FALSE(pacer.Due(due_s - 1e-6));
      EXPECT_TRUE(pacer.Due(due_s + 1e-6));
      pacer.Open(due_s + 1e-6);
    }
  }
}

TEST(Pacer, DelaysDoNotAddUp) {
  Pacer pacer = Running(1.0);
  for (int k = 1; k <= 100; ++k) pacer.Open(kStart_s + 0.1 * k + 0.03);
  EXPECT_NEAR(pacer.due_s(), kStart_s + 0.1 * 101, 1e-9);
}

TEST(Pacer, AShortDelayIsCaughtUp) {
  Pacer pacer = Running(1.0);
  const double late_s = kStart_s + 0.1 + 0.45;  // 4.5 periods after step 1 was due
  for (int k = 2; k <= 5; ++k) {
    pacer.Open(late_s);
    EXPECT_TRUE(pacer.Due(late_s)) << k;
  }
  pacer.Open(late_s);
  EXPECT_FALSE(pacer.Due(late_s));
  EXPECT_NEAR(pacer.due_s(), kStart_s + 0.6, 1e-9) << "back on the grid";
}

TEST(Pacer, ALongDelayIsLetGo) {
  const auto due_after = [](double late_s) {
    Pacer pacer = Running(1.0);
    pacer.Open(kStart_s + 0.2 + late_s);
    return pacer.due_s() - kStart_s;
  };
  EXPECT_NEAR(due_after(0.499), 0.2, 1e-9);
  EXPECT_NEAR(due_after(0.501), 0.701, 1e-9);
  EXPECT_NEAR(due_after(60.0), 60.2, 1e-9);

  Pacer pacer = Running(1.0);
  pacer.Open(kStart_s + 60.0);
  EXPECT_TRUE(pacer.Due(kStart_s + 60.0)) << "one step at once";
  pacer.Open(kStart_s + 60.0);
  EXPECT_FALSE(pacer.Due(kStart_s + 60.0)) << "then at the usual pace";
  EXPECT_NEAR(pacer.due_s(), kStart_s + 60.1, 1e-9);
}

TEST(Pacer, StepsThatAreOpenedTooSoonDoNotPutOffTheNext) {
  Pacer pacer = Running(1.0);
  for (int k = 0; k < 1000; ++k) pacer.Open(kStart_s + 0.05);  // a burst of resets
  EXPECT_NEAR(pacer.due_s(), kStart_s + 0.15, 1e-9);
}

TEST(Pacer, InLockstepAStepIsDueAtOnceAndHasItsOwnPatience) {
  Pacer pacer = Running(0.0);
  EXPECT_TRUE(pacer.lockstep());
  for (const double now_s : {kStart_s, kStart_s + 1e-4, kStart_s + 500.0}) {
    pacer.Open(now_s);
    EXPECT_TRUE(pacer.Due(now_s));
    EXPECT_EQ(pacer.due_s(), now_s);
    EXPECT_EQ(pacer.deadline_s(), now_s + 0.5);
  }
}

TEST(Pacer, WhilePausedNothingIsDue) {
  for (const double factor : {0.0, 1.0}) {
    Pacer pacer = Running(factor);
    pacer.Pause();
    pacer.Pause();
    EXPECT_TRUE(pacer.paused());
    EXPECT_FALSE(pacer.Due(kStart_s + 50.0));
    EXPECT_EQ(pacer.WaitTime(kStart_s + 50.0, kNoVehicle), Pacer::kIdleWait_s);
    pacer.Resume(kStart_s + 60.0);
    EXPECT_FALSE(pacer.paused());
    EXPECT_TRUE(pacer.Due(kStart_s + 60.0));
    EXPECT_EQ(pacer.deadline_s(), kStart_s + 60.5) << "answers are due anew";
    pacer.Open(kStart_s + 60.0);
    EXPECT_NEAR(pacer.due_s(), kStart_s + (factor > 0.0 ? 60.1 : 60.0), 1e-9) << "no hurry";
  }
}

TEST(Pacer, APauseBeforeTheRunBeginsRenewsThePatienceOfTheStart) {
  Pacer pacer(OptionsOf(1.0));
  pacer.Open(kStart_s);
  pacer.Pause();
  pacer.Resume(kStart_s + 100.0);
  EXPECT_EQ(pacer.deadline_s(), kStart_s + 130.0);
  EXPECT_FALSE(pacer.Due(kStart_s + 200.0));
}

TEST(Pacer, ResumingWhatIsNotPausedRenewsNothing) {
  Pacer pacer = Running(0.0);
  pacer.Resume(kStart_s + 0.4);
  EXPECT_EQ(pacer.deadline_s(), kStart_s + 0.5);
  EXPECT_EQ(pacer.due_s(), kStart_s);
}

TEST(Pacer, WaitsUntilTheStepIsDueOrSomebodyIsGivenUp) {
  const Pacer pacer = Running(1.0);
  EXPECT_NEAR(pacer.WaitTime(kStart_s + 0.06, kNoVehicle), 0.04, 1e-9) << "all are in";
  EXPECT_NEAR(pacer.WaitTime(kStart_s + 0.06, kStart_s + 0.07), 0.01, 1e-9);
  EXPECT_EQ(pacer.WaitTime(kStart_s + 0.2, kNoVehicle), 0.0) << "overdue";
  const Pacer slow = Running(0.01);
  EXPECT_EQ(slow.WaitTime(kStart_s, kNoVehicle), Pacer::kLongestWait_s);
  const Pacer lockstep = Running(0.0);
  EXPECT_EQ(lockstep.WaitTime(kStart_s + 0.1, kNoVehicle), 0.0);
  EXPECT_NEAR(lockstep.WaitTime(kStart_s + 0.4, lockstep.deadline_s()), 0.1, 1e-9);
}

}  // namespace
}  // namespace stg

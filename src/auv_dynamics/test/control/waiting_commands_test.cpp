#include "auv_dynamics/control/waiting_commands.hpp"

#include <gtest/gtest.h>

namespace stg::dynamics {
namespace {

constexpr TimeNs kPeriod = 100'000'000;

WaitingCommands::Command At(TimeNs stamp, double speed = 0.0) { return {stamp, {speed, 0.0, 0.0}}; }

TimeNs Step(int k) { return 11'000'000'000 + k * kPeriod; }

TEST(WaitingCommands, EveryCommandMeetsItsOdometryHoweverFarItIsAhead) {
  WaitingCommands waiting(kPeriod, 0);
  EXPECT_EQ(waiting.Advance(Step(0)), 0);
  const int ahead = static_cast<int>(WaitingCommands::kMost);
  for (int k = 1; k <= ahead; ++k) EXPECT_EQ(waiting.Add(At(Step(k), k)), 0);
  EXPECT_EQ(waiting.Current(), nullptr);
  for (int k = 1; k <= ahead; ++k) {
    EXPECT_EQ(waiting.Advance(Step(k)), 0);
    ASSERT_NE(waiting.Current(), nullptr) << "step " << k;
    EXPECT_EQ(waiting.Current()->v_des_W.x, k);
    waiting.Take();
    EXPECT_EQ(waiting.Current(), nullptr);
  }
}

TEST(WaitingCommands, OneThatTheOdometryHasPassedIsDroppedAndCounted) {
  WaitingCommands waiting(kPeriod, 0);
  waiting.Advance(Step(0));
  waiting.Add(At(Step(1)));
  waiting.Add(At(Step(2)));
  EXPECT_EQ(waiting.Advance(Step(2)), 1);
  EXPECT_EQ(waiting.Current()->stamp, Step(2));
}

TEST(WaitingCommands, OneBeyondReachWaitsForTheNextOdometryAlone) {
  WaitingCommands waiting(kPeriod, 0);
  waiting.Advance(Step(600));
  waiting.Add(At(Step(1200)));
  EXPECT_EQ(waiting.Advance(Step(601)), 1);
  waiting.Add(At(Step(0)));  // it belongs to another run, and came before the odometry of that run
  EXPECT_EQ(waiting.Current(), nullptr);
  EXPECT_EQ(waiting.Advance(Step(0)), 0);
  EXPECT_EQ(waiting.Current()->stamp, Step(0));
}

TEST(WaitingCommands, OfTheSameStampTheLastOneCounts) {
  WaitingCommands waiting(kPeriod, 0);
  waiting.Add(At(Step(1), 1.0));
  waiting.Add(At(Step(1), 2.0));
  waiting.Advance(Step(1));
  EXPECT_EQ(waiting.Current()->v_des_W.x, 2.0);
}

TEST(WaitingCommands, WhenTooManyWaitTheFirstOneGoes) {
  WaitingCommands waiting(kPeriod, 0);
  for (int k = 0; k < static_cast<int>(WaitingCommands::kMost); ++k) waiting.Add(At(Step(k)));
  EXPECT_EQ(waiting.Add(At(Step(100))), 1);
  EXPECT_EQ(waiting.Advance(Step(0)), 1);  // the refused command is a hundred steps ahead
  EXPECT_EQ(waiting.Current(), nullptr);
}

TEST(WaitingCommands, AnAutopilotSteersByTheNewestThatIsNotAPeriodOld) {
  WaitingCommands waiting(kPeriod, kPeriod - 1);
  waiting.Add(At(Step(1), 1.0));
  waiting.Add(At(Step(2), 2.0));
  for (const TimeNs part : {TimeNs{0}, kPeriod / 2}) {
    EXPECT_EQ(waiting.Advance(Step(1) + part), 0);
    ASSERT_NE(waiting.Current(), nullptr);
    EXPECT_EQ(waiting.Current()->v_des_W.x, 1.0);
    waiting.Take();
  }
  EXPECT_EQ(waiting.Advance(Step(2)), 0) << "the first one has acted";
  EXPECT_EQ(waiting.Current()->v_des_W.x, 2.0);
  EXPECT_EQ(waiting.Advance(Step(3)), 1) << "the second one has not";
  EXPECT_EQ(waiting.Current(), nullptr);
}

}  // namespace
}  // namespace stg::dynamics

// Which own detections are used where sensors have false alarms.

#include "stg_agent/inbox/confirmation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "association/unlabelled.hpp"
#include "auv_common/config/loader.hpp"
#include "stg_agent/inbox/inbox.hpp"

namespace stg::agent {
namespace {

using dynamics::Detection;

constexpr double kPeriod_s = 5.0, kReach_m = 600.0;

AgentModel Model(double false_alarms) {
  FleetOptions o;
  o.drift = false;
  AgentScenario s = FleetScenario(o);
  s.world.sensing.period_s = kPeriod_s;
  config::Override(&s, {"sensing.range.false_alarm_probability=" + std::to_string(false_alarms)});
  return s.model();
}

TimeNs LookTime(int look) { return static_cast<TimeNs>(look * kPeriod_s) * kSecond_ns; }

Detection RangeInLook(int look, double range_m) {
  Detection d;
  d.stamp = LookTime(look);
  d.kind = dynamics::MeasurementKind::kRange;
  d.p_WO = {0.0, 0.0, -40.0};
  d.range_m = range_m;
  d.range_std_m = 1.0 + 0.01 * range_m;
  return d;
}

TEST(Confirmation, UsesEveryDetectionWithoutFalseAlarms) {
  Confirmation confirmation(Model(0.0));
  for (int look = 0; look < 4; ++look) {
    EXPECT_TRUE(confirmation.Take(RangeInLook(look, 100.0 * look)));
  }
}

TEST(Confirmation, UsesADetectionThatThreeOfTheFiveLooksBeforeSupport) {
  Confirmation confirmation(Model(0.2));
  EXPECT_FALSE(confirmation.Take(RangeInLook(0, 300.0)));
  EXPECT_FALSE(confirmation.Take(RangeInLook(2, 302.0)));
  EXPECT_FALSE(confirmation.Take(RangeInLook(3, 301.0)));   // looks 0 and 2 support it
  EXPECT_TRUE(confirmation.Take(RangeInLook(5, 297.0)));    // 0, 2 and 3
  EXPECT_TRUE(confirmation.Take(RangeInLook(7, 299.0)));    // 2, 3 and 5
  EXPECT_FALSE(confirmation.Take(RangeInLook(8, 550.0)));   // nothing is near
  EXPECT_FALSE(confirmation.Take(RangeInLook(14, 300.0)));  // all others are older than five looks
  confirmation.Clear();
  EXPECT_FALSE(confirmation.Take(RangeInLook(15, 300.0)));
}

TEST(Confirmation, AlwaysUsesBearings) {
  Confirmation confirmation(Model(0.2));
  Detection d = RangeInLook(0, 300.0);
  d.kind = dynamics::MeasurementKind::kBearing;
  EXPECT_TRUE(confirmation.Take(d));
}

/// Probability that three or more of n looks support a false alarm, each with the probability p.
double ThreeOrMore(int n, double p) {
  return 1.0 - std::pow(1.0 - p, n) - n * p * std::pow(1.0 - p, n - 1) -
         0.5 * n * (n - 1) * p * p * std::pow(1.0 - p, n - 2);
}

TEST(Confirmation, PassesNoMoreFalseAlarmsThanComputed) {
  const double q = 0.2;
  const AgentModel s = Model(q);
  // The pair that may differ most gives the upper bound: the looks farthest apart, the worst noise.
  const double fits_m =
      OneTarget(s).Reach(RangeInLook(0, kReach_m), RangeInLook(Confirmation::kLooks, kReach_m));
  const double most = ThreeOrMore(Confirmation::kLooks, q * 2.0 * fits_m / kReach_m);
  Confirmation confirmation(s);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int alarms = 0, used = 0;
  for (int look = 0; look < 400000; ++look) {
    if (share(random) >= q) continue;
    ++alarms;
    used += confirmation.Take(RangeInLook(look, kReach_m * share(random))) ? 1 : 0;
  }
  const double rate = static_cast<double>(used) / alarms;
  EXPECT_LT(rate, most);
  EXPECT_GT(rate, 0.05 * most) << "the bound is not far off";
  EXPECT_LT(most, 0.002);
}

TEST(Confirmation, FalseAlarmsDoNotMoveTheEstimateOfATargetOutOfRange) {
  const auto constants = std::make_shared<const AgentConstants>(Model(0.2));
  Inbox inbox(constants, 0);
  const NeighbourTable neighbours(constants->model, 0);
  const Vec3<double> target{900.0, 0.0, -40.0};
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  dynamics::Cue cue;
  cue.target = constants->model.target.of(0);
  cue.p_WT = target;
  cue.std_m = 50.0;
  inbox.Reset(0, cue);
  for (int look = 1; look <= 120; ++look) {  // ten minutes
    Detection d = RangeInLook(look, kReach_m * share(random));
    d.target = cue.target;
    if (share(random) < 0.2) inbox.Detect(d);
    inbox.Advance(LookTime(look), neighbours);
  }
  const TargetBelief b = inbox.belief();
  const double x = b.p_WT.x - target.x, y = b.p_WT.y - target.y;
  const double det = b.P_WT.xx * b.P_WT.yy - b.P_WT.xy * b.P_WT.xy;
  const double distance2 = (b.P_WT.yy * x * x - 2.0 * b.P_WT.xy * x * y + b.P_WT.xx * y * y) / det;
  EXPECT_LT(distance2, 9.21) << "99 % of a chi square with two degrees of freedom";
  EXPECT_GT(b.position_std_m(), 100.0) << "nothing has measured the target";
}

}  // namespace
}  // namespace stg::agent

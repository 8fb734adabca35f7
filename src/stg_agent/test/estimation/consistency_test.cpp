// The filter of measurements knows how wrong it is: over 200 episodes the mean squared error in
// units of the stated covariance stays below the upper 99 % bound of chi-squared, for every sensor,
// loss and age, with dead reckoning and targets that turn. Conservative is allowed, boasting not.

#include <gtest/gtest.h>

#include <array>

#include "estimation/fleet.hpp"

namespace stg::agent {
namespace {

constexpr int kEpisodes = 200;
/// 99.5 % quantile of chi-squared with 3 * 200 degrees of freedom, over 200 (Wilson, Hilferty).
constexpr double kUpper = 3.468;
/// Nobody needs a filter that knows nothing.
constexpr double kLower = 0.8;
constexpr int kChecks = 3;

struct Consistency {
  std::array<double, kChecks> nees{}, error_m{};
};

Consistency Judge(const FleetOptions& o, const AgentScenario& s) {
  Fleet fleet(s, o);
  Consistency c;
  for (int e = 0; e < kEpisodes; e += kLanes) {
    fleet.Fly(static_cast<std::uint64_t>(1000 + e), kChecks, [&](const Judgement& j, int check) {
      c.nees[static_cast<std::size_t>(check)] += j.nees / kEpisodes;
      c.error_m[static_cast<std::size_t>(check)] += j.error_m * j.error_m / kEpisodes;
    });
  }
  for (double& e : c.error_m) e = std::sqrt(e);
  return c;
}

void ExpectConsistent(const FleetOptions& o) {
  const Consistency c = Judge(o, FleetScenario(o));
  for (std::size_t check = 0; check < kChecks; ++check) {
    EXPECT_LT(c.nees[check], kUpper)
        << o.sensor << ", " << o.observers << " AUVs, loss " << o.loss << ", check " << check;
    EXPECT_GT(c.nees[check], kLower) << o.sensor << ", check " << check;
  }
  std::printf(
      "%-13s %d AUVs, loss %.1f, age %2.0f s: NEES %.2f %.2f %.2f, error %.1f %.1f %.1f m\n",
      o.sensor.c_str(), o.observers, o.loss, o.longest_age_s, c.nees[0], c.nees[1], c.nees[2],
      c.error_m[0], c.error_m[1], c.error_m[2]);
}

class Sensors : public ::testing::TestWithParam<const char*> {
 protected:
  FleetOptions Options(int observers) const {
    FleetOptions o;
    o.sensor = GetParam();
    o.observers = observers;
    o.seconds = 150.0;
    return o;
  }
};

TEST_P(Sensors, OneObserverIsHonest) { ExpectConsistent(Options(1)); }

TEST_P(Sensors, TwoThatShareAreHonestWhateverIsLostOrLate) {
  FleetOptions o = Options(2);
  ExpectConsistent(o);
  o.loss = 0.3;
  o.longest_age_s = 20.0;
  ExpectConsistent(o);
  o.loss = 0.7;
  o.longest_age_s = 60.0;
  ExpectConsistent(o);
}

TEST_P(Sensors, OutliersAndFalseAlarmsAreSetAside) {
  if (std::string(GetParam()) == "position") return;  // has none
  const FleetOptions o = Options(2);
  AgentScenario s = FleetScenario(o);
  s.world.sensing.outlier_probability = 0.02;
  s.world.sensing.false_alarm_probability = 0.02;
  const Consistency c = Judge(o, s);
  for (const double nees : c.nees) EXPECT_LT(nees, kUpper) << o.sensor;
}

INSTANTIATE_TEST_SUITE_P(Filter, Sensors,
                         ::testing::Values("position", "range", "bearing", "range_bearing"));

TEST(Consistency, PerfectNavigationLeavesNothingButNoise) {
  FleetOptions o;
  o.drift = false;
  o.seconds = 150.0;
  ExpectConsistent(o);
}

TEST(Consistency, ATargetThatNeverTurnsIsNoSurprise) {
  FleetOptions o;
  o.motion = "constant_velocity";
  o.seconds = 150.0;
  ExpectConsistent(o);
}

TEST(Consistency, TwoObserversThatShareBeatOneByWhatGeometrySays) {
  FleetOptions o;
  o.seconds = 150.0;
  o.observers = 1;
  const Consistency one = Judge(o, FleetScenario(o));
  o.observers = 2;
  const Consistency two = Judge(o, FleetScenario(o));
  o.observers = 4;
  const Consistency four = Judge(o, FleetScenario(o));
  // One range leaves an arc, two leave a point, more of them average.
  EXPECT_LT(two.error_m[2], 0.5 * one.error_m[2]);
  EXPECT_LT(four.error_m[2], two.error_m[2]);
  EXPECT_LT(four.error_m[2], 6.0);
}

TEST(Consistency, AnAmbiguousBearingIsResolvedByTwo) {
  FleetOptions o;
  o.sensor = "bearing";
  o.seconds = 150.0;
  o.observers = 3;
  AgentScenario s = FleetScenario(o);
  s.world.sensing.ambiguous = true;
  const Consistency c = Judge(o, s);
  for (const double nees : c.nees) EXPECT_LT(nees, kUpper);
  EXPECT_LT(c.error_m[2], 15.0);
}

}  // namespace
}  // namespace stg::agent

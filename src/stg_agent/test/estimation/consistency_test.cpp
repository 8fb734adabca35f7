// The filter of measurements knows how large its error is. Over 200 episodes, the mean squared
// error in units of the stated covariance stays below the upper 99 % bound of chi-squared. This
// holds for every sensor, loss and age, with dead reckoning and targets that turn. The stated error
// may be too large, but not too small.

#include <gtest/gtest.h>

#include <array>

#include "auv_common/config/loader.hpp"
#include "estimation/fleet.hpp"

namespace stg::agent {
namespace {

constexpr int kEpisodes = 200;
/// 99.5 % quantile of chi-squared with 3 * 200 degrees of freedom, over 200 (Wilson, Hilferty).
constexpr double kUpper = 3.468;
/// A filter must not state much larger errors than it has.
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
  if (std::string(GetParam()) == "position") return;  // this sensor has none
  const FleetOptions o = Options(2);
  AgentScenario s = FleetScenario(o);
  config::Override(&s, {"sensing." + s.world.sensing.sensor + ".outlier_probability=0.02"});
  config::Override(&s, {"sensing." + s.world.sensing.sensor + ".false_alarm_probability=0.02"});
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
  // One range leaves an arc and two leave a point. More ranges reduce the error by averaging.
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
  config::Override(&s, {"sensing." + s.world.sensing.sensor + ".ambiguous=true"});
  const Consistency c = Judge(o, s);
  for (const double nees : c.nees) EXPECT_LT(nees, kUpper);
  EXPECT_LT(c.error_m[2], 15.0);
}

/// Returns the root mean square error of the vector that AUV 0 steers by, and the mean NEES. The
/// flight takes a quarter of an hour, in which no log sees the bottom.
std::pair<double, double> Adrift(ObserverErrors errors, const std::array<double, 3>& current) {
  FleetOptions o;
  o.observers = 4;
  o.seconds = 900.0;
  o.look_steps = 5;
  AgentScenario s = FleetScenario(o);
  s.world.navigation.dvl_altitude_m = 10.0;
  s.world.current.velocity_mps = current;
  s.agent.track.observers = errors;
  Fleet fleet(s, o);
  constexpr int kFlights = 40;
  double square = 0.0, nees = 0.0;
  for (int e = 0; e < kFlights; e += kLanes) {
    fleet.Fly(static_cast<std::uint64_t>(9000 + e), 1, [&](const Judgement& j, int) {
      square += j.relative_m * j.relative_m / kFlights;
      nees += j.nees / kFlights;
    });
  }
  return {std::sqrt(square), nees};
}

TEST(Consistency, ACurrentThatCarriesAllBlursNothingThatIsSteeredBy) {
  const auto [still_m, still] = Adrift(ObserverErrors::kRates, {0.0, 0.0, 0.0});
  const auto [moved_m, moved] = Adrift(ObserverErrors::kRates, {0.1, 0.06, 0.0});
  const auto [steps_m, steps] = Adrift(ObserverErrors::kSteps, {0.0, 0.0, 0.0});
  std::printf("adrift: rates %.1f m, NEES %.2f; in a current %.1f m, %.2f; steps %.1f m, %.2f\n",
              still_m, still, moved_m, moved, steps_m, steps);
  EXPECT_LT(still_m, 10.0);
  EXPECT_NEAR(moved_m, still_m, 0.5 * still_m);
  EXPECT_GT(steps_m, 1.5 * still_m) << "steps do as well: what are rates for?";
  EXPECT_LT(still, kUpper);
  // All flights have the same current. Its own share of NEES is (0.1^2 + 0.06^2) / 0.1^2.
  EXPECT_LT(moved, 1.36 + kUpper);
}

}  // namespace
}  // namespace stg::agent

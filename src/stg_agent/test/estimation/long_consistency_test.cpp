// The filter of measurements states true errors for as long as a battery lasts. It flies for 9,000
// s with navigation that drifts, compasses that are wrong by degrees, an unknown current, and AUVs
// that all see the target from one place.

#include <gtest/gtest.h>

#include <cstdio>

#include "auv_common/config/loader.hpp"
#include "estimation/fleet.hpp"

namespace stg::agent {
namespace {

constexpr int kFlights = 4;  // rounded up to a multiple of kLanes
constexpr int kChecks = 9;
/// 99.5 % quantile of chi-squared with 3 degrees of freedom per flight, over the number of flights
/// (Wilson, Hilferty). Checks of one flight share errors, so they count as one.
double Upper() {
  const double n = 3.0 * kFlights, c = 2.0 / (9.0 * n);
  return n * std::pow(1.0 - c + 2.576 * std::sqrt(c), 3.0) / kFlights;
}

struct Long {
  double nees = 0.0, own_m = 0.0;
};

/// Judges the second half of the flights.
Long Judge(const FleetOptions& o, const AgentScenario& s, const char* what) {
  Fleet fleet(s, o);
  Long sum;
  int count = 0;
  for (int e = 0; e < kFlights; e += kLanes) {
    fleet.Fly(static_cast<std::uint64_t>(2000 + e), kChecks, [&](const Judgement& j, int check) {
      if (2 * check < kChecks) return;
      sum.nees += j.nees;
      sum.own_m += j.relative_m * j.relative_m;
      ++count;
    });
  }
  sum.nees /= count;
  sum.own_m = std::sqrt(sum.own_m / count);
  std::printf("%-34s NEES %.2f, own frame %.1f m\n", what, sum.nees, sum.own_m);
  return sum;
}

FleetOptions LongFlight() {
  FleetOptions o;
  o.observers = 4;
  o.seconds = 9000.0;
  o.look_steps = 5;
  o.interval_s = 5.0;
  o.turn_period_s = 120.0;
  return o;
}

/// The log does not reach the bottom, and no AUV knows the current.
AgentScenario UnknownWater(const FleetOptions& o) {
  AgentScenario s = FleetScenario(o);
  s.world.navigation.dvl_altitude_m = 10.0;
  s.world.current.velocity_mps = {0.08, 0.05, 0.0};
  s.agent.track.observers = ObserverErrors::kRates;
  return s;
}

TEST(LongConsistency, NavigationThatDriftsWithTheWayRun) {
  const FleetOptions o = LongFlight();
  EXPECT_LT(Judge(o, FleetScenario(o), "bottom lock").nees, Upper());
}

TEST(LongConsistency, CompassesThatAreWrongByDegrees) {
  FleetOptions o = LongFlight();
  o.sensor = "range_bearing";
  AgentScenario s = FleetScenario(o);
  s.world.navigation.heading_std_deg = 2.0;
  // With a wrong heading, the position error grows on the way out and shrinks on the way back.
  // `steps` takes it for new errors each time and averages over them, so its NEES here is above 20.
  s.agent.track.observers = ObserverErrors::kRates;
  EXPECT_LT(Judge(o, s, "compasses off by 2 degrees").nees, Upper());
}

TEST(LongConsistency, WaterThatNobodyKnows) {
  const FleetOptions o = LongFlight();
  const AgentScenario s = UnknownWater(o);
  const Long flown = Judge(o, s, "no bottom, a current");
  // All flights have the same current. Its own share of NEES is 0.89, and not the expected 2.
  EXPECT_LT(flown.nees, Upper());
  EXPECT_LT(flown.own_m, 20.0);
}

TEST(LongConsistency, LargeSwarmInWaterThatNobodyKnows) {
  FleetOptions o = LongFlight();
  o.observers = 12;
  o.seconds = 2700.0;
  o.interval_s = 36.0;
  const AgentScenario s = UnknownWater(o);
  const Long flown = Judge(o, s, "twelve, no bottom, a current");
  EXPECT_LT(flown.nees, Upper());
  // The error of each observer is remembered from packet to packet.
  EXPECT_LT(flown.own_m, 8.0);
}

TEST(LongConsistency, FourInAPileAreOneObserver) {
  FleetOptions o = LongFlight();
  o.pile = true;
  EXPECT_LT(Judge(o, FleetScenario(o), "a pile").nees, Upper());
}

TEST(LongConsistency, APileInWaterThatNobodyKnows) {
  FleetOptions o = LongFlight();
  o.pile = true;
  const AgentScenario s = UnknownWater(o);
  EXPECT_LT(Judge(o, s, "a pile, no bottom, a current").nees, Upper());
}

}  // namespace
}  // namespace stg::agent

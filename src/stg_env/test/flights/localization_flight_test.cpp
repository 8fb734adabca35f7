// Whole flights without bottom lock: what ranges among AUVs, a craft and beacons are worth, and
// that nobody pretends to know more than that.

#include <gtest/gtest.h>

#include <cstdio>

#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_env/env/evaluation.hpp"

namespace stg::env {
namespace {

constexpr int kFlights = 8;

/// Mean over the flights of a quarter of an hour.
task::MetricSummary Fly(const std::string& condition, const std::vector<std::string>& keys = {}) {
  Scenario s = Short(Shipped("deep", condition, keys), 900);
  s.run.time.tail_steps = 300;
  const auto flights = Evaluate(EnvFactory(s), agent::MakeDecider("encircle", s.model()),
                                {kFlights, 500, kMixBlock}, nullptr);
  task::MetricSummary m = task::Summarise(flights);
  std::printf(
      "%-18s position %.1f m, NEES %.2f; relative %.2f m; target in own frame %.1f m; band %.3f, "
      "lost %.3f\n",
      condition.c_str(), m.Mean("navigation_rmse_tail"), m.Mean("navigation_nees"),
      m.Mean("relative_rmse"), m.Mean("own_rmse_tail"), m.Mean("band_share"),
      m.Mean("whole_lost_rate"));
  return m;
}

/// It knows where it is, as well as it says.
void ExpectLocated(const task::MetricSummary& m) {
  EXPECT_LT(m.Mean("navigation_rmse_tail"), 8.0);
  EXPECT_LT(m.Mean("navigation_nees"), 5.0);
}

TEST(LocalizationFlight, AloneTheSwarmHoldsTogetherAndDriftsAway) {
  const task::MetricSummary m = Fly("nominal");
  EXPECT_GT(m.Mean("navigation_rmse_tail"), 50.0);
  EXPECT_LT(m.Mean("navigation_nees"), 5.0);
  EXPECT_LT(m.Mean("relative_rmse"), 3.0);
  EXPECT_LT(m.Mean("own_rmse_tail"), 15.0);
  EXPECT_GT(m.Mean("band_share"), 0.75);
}

TEST(LocalizationFlight, ACraftHoldsTheSwarmInTheWorld) {
  const task::MetricSummary m = Fly("craft");
  ExpectLocated(m);
  EXPECT_LT(m.Mean("relative_rmse"), 3.0);
  EXPECT_GT(m.Mean("band_share"), 0.75);
}

TEST(LocalizationFlight, TwoBeaconsDoSoToo) { ExpectLocated(Fly("beacons")); }

// Packets hold positions modulo 5 km, and an AUV can be 2.5 km from a beacon along one axis.
TEST(LocalizationFlight, BeaconsOnTheEdgeAreTakenForWhereTheyAre) {
  ExpectLocated(Fly("beacons", {"stations.beacons=[[1900, 1900, -100], [-1900, -1900, -100]]"}));
}

TEST(LocalizationFlight, LateSoundsAreSetAside) {
  EXPECT_LT(Fly("craft_late_sound").Mean("navigation_rmse_tail"), 10.0);
}

TEST(LocalizationFlight, WhatDoesNotGoTogetherIsRefusedByName) {
  const auto error = [](const std::vector<std::string>& keys) {
    try {
      Shipped("deep", "nominal", keys);
    } catch (const UserError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(error({"navigation.dead_reckoning.gps_depth_m=0.3"}).find("gps_depth_m"),
            std::string::npos);
  EXPECT_NE(error({"track.measurements.observers=rates"}).find("observers"), std::string::npos);
  EXPECT_NE(error({"localization.kind=uncorrected"}).find("localization.kind"), std::string::npos);
  EXPECT_NE(error({"agents=28", "stations.crafts=[[0,0],[1,1],[2,2],[3,3]]"}).find("31 AUVs"),
            std::string::npos);
  // A station without anybody who makes use of it.
  EXPECT_THROW(Shipped("field", "nominal", {"stations.crafts=[[0,0]]"}), UserError);
}

}  // namespace
}  // namespace stg::env

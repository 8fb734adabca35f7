// Whole flights without bottom lock. They show how good ranges among AUVs, a craft and beacons are.
// They also show that no AUV claims to know more than that.

#include <gtest/gtest.h>

#include <cstdio>

#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_env/env/evaluation.hpp"

namespace stg::env {
namespace {

constexpr int kFlights = 8;

/// The mean metrics of flights of a quarter of an hour.
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

/// The AUV knows where it is, and its stated error is right.
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

TEST(LocalizationFlight, BearingsFromTheCraftPlaceTheSwarmBetter) {
  const task::MetricSummary both = Fly("craft_usbl");
  ExpectLocated(both);
  const task::MetricSummary ranges = Fly("craft_usbl", {"stations.usbl_std_deg=0.0"});
  EXPECT_LT(both.Mean("navigation_rmse_tail"), ranges.Mean("navigation_rmse_tail"));
}

TEST(LocalizationFlight, TwoBeaconsDoSoToo) { ExpectLocated(Fly("beacons")); }

// Packets hold positions modulo 5 km, and an AUV can be 2.5 km from a beacon along one axis.
TEST(LocalizationFlight, BeaconsOnTheEdgeAreTakenForWhereTheyAre) {
  ExpectLocated(Fly("beacons", {"stations.beacons=[[1900, 1900, -100], [-1900, -1900, -100]]"}));
}

// The clocks of craft_ping are off by a second. This changes travel times of packets, and no ping.
TEST(LocalizationFlight, PingsNeedNoCommonClock) {
  const task::MetricSummary pings = Fly("craft_ping");
  ExpectLocated(pings);
  EXPECT_LT(pings.Mean("relative_rmse"), 4.0);
  EXPECT_GT(pings.Mean("pings"), 25.0);
  const task::MetricSummary taken_for_right =
      Fly("craft_ping", {"localization.ranges.by=one_way",
                         "believed.channel.physical.modem.clock_offset_std_s=0.0",
                         "believed.channel.physical.modem.clock_drift_std_ppm=0.0"});
  EXPECT_GT(taken_for_right.Mean("navigation_nees"), 20.0);
}

TEST(LocalizationFlight, CrystalClocksAreEstimated) {
  const task::MetricSummary crystal = Fly("craft_crystal");
  ExpectLocated(crystal);
  EXPECT_LT(crystal.Mean("relative_rmse"), 3.0);
  // Without a craft, no clock is right. All of them are wrong by about a second.
  ExpectLocated(Fly("beacons", {"localization.ranges.clocks=estimated",
                                "channel.physical.modem.clock_offset_std_s=1.0"}));
}

// A beacon's own ranges together with those of the AUVs show how far apart their clocks are. With
// the AUVs' ranges alone, the positions are five times as wrong.
TEST(LocalizationFlight, RangesInBothDirectionsFindTheDriftOfBeaconClocks) {
  const task::MetricSummary m = Fly("beacons", {"localization.ranges.clocks=estimated",
                                                "channel.physical.modem.clock_drift_std_ppm=10.0"});
  EXPECT_LT(m.Mean("navigation_rmse_tail"), 4.0);
  EXPECT_LT(m.Mean("navigation_nees"), 5.0);
}

// The beacon is up to 4.5 km away. Slots that are too short for this way let its packets come in
// the slot of the next member, so that some AUVs do not hear each other for a long time.
TEST(LocalizationFlight, PacketsOfAFarBeaconArriveInTheirOwnSlots) {
  for (const char* condition : {"beacon", "beacons"}) {
    const task::MetricSummary m =
        Fly(condition, {"stations.beacons=[[1500, 1500, -100], [-1500, -1500, -100], "
                        "[1500, -1500, -100], [-1500, 1500, -100]]"});
    EXPECT_LT(m.Mean("packet_loss"), 0.01) << condition;
    EXPECT_LT(m.Mean("relative_rmse"), 3.0) << condition;
  }
}

TEST(LocalizationFlight, BearingsFromABeaconPlaceTheSwarmBetter) {
  const task::MetricSummary ranges = Fly("beacon");
  const task::MetricSummary both = Fly("beacon", {"stations.usbl_std_deg=0.3"});
  EXPECT_LT(both.Mean("navigation_rmse_tail"), 0.8 * ranges.Mean("navigation_rmse_tail"));
  EXPECT_LT(both.Mean("navigation_nees"), 5.0);
}

// Ranges by ping do not depend on the offsets of the clocks. The flights differ only by rounding,
// half a nanosecond.
TEST(LocalizationFlight, ADriftingClockMovesARangeByLessThanAMillimetre) {
  const task::MetricSummary drifting = Fly("craft_ping");
  const task::MetricSummary right =
      Fly("craft_ping", {"channel.physical.modem.clock_drift_std_ppm=0.0"});
  EXPECT_NEAR(drifting.Mean("navigation_rmse"), right.Mean("navigation_rmse"), 0.05);
}

TEST(LocalizationFlight, LateSoundsAreSetAside) {
  EXPECT_LT(Fly("craft_late_sound").Mean("navigation_rmse_tail"), 10.0);
}

TEST(LocalizationFlight, AFixOfOneServesAll) {
  const task::MetricSummary up = Fly("surfacing");
  EXPECT_LT(up.Mean("navigation_rmse_tail"), 40.0);
  EXPECT_LT(up.Mean("navigation_nees"), 5.0);
  EXPECT_GT(up.Mean("band_share"), 0.7);
  EXPECT_GE(up.Mean("fixes"), 2.0);
  EXPECT_LT(up.Mean("fixes"), 5.0);
  EXPECT_GT(up.Mean("surface_share"), 0.02);
  EXPECT_LT(up.Mean("surface_share"), 0.25);
  EXPECT_GT(up.Mean("navigation_rmse_before_fix"), 10.0);
  EXPECT_LT(up.Mean("navigation_rmse_before_fix"), 60.0);
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
  // The clocks are too wrong for ranges from travel times.
  const std::string drift = "channel.physical.modem.clock_drift_std_ppm=1.0";
  EXPECT_NE(error({drift}).find("localization.ranges.clocks"), std::string::npos);
  EXPECT_EQ(error({drift, "localization.ranges.clocks=estimated"}), "");
  EXPECT_EQ(error({drift, "localization.ranges.by=ping"}), "");
  EXPECT_NE(error({"localization.ranges.by=ping", "localization.ranges.clocks=estimated"})
                .find("localization.ranges.by"),
            std::string::npos);
  EXPECT_NE(error({"stations.usbl_std_deg=1.0"}).find("stations.crafts"), std::string::npos);
  // These keys belong to things that the scenario did not choose.
  EXPECT_NE(error({"localization.ranges.ping_period_s=20.0"}).find("localization.ranges.by"),
            std::string::npos);
  EXPECT_NE(error({"stations.gps_std_m=1.0"}).find("stations.crafts"), std::string::npos);
  // Refused are a period that is no whole number of decisions, and one that is too short for a turn
  // and for the way there and back.
  const std::string by = "localization.ranges.by=ping";
  EXPECT_NE(error({by, "localization.ranges.ping_period_s=20.5"}).find("whole"), std::string::npos);
  EXPECT_NE(error({by, "localization.ranges.ping_period_s=9.0"}).find("ping_period_s"),
            std::string::npos);
  EXPECT_NE(error({"localization.ranges.surface_std_m=25.0"}).find("fixes: reported"),
            std::string::npos);
  EXPECT_NE(error({"navigation.dead_reckoning.gps_first_fix_s=10.0"}).find("fixes"),
            std::string::npos);
  EXPECT_THROW(Shipped("field", "nominal", {"navigation.dead_reckoning.fixes=reported"}),
               UserError);
  // No AUV uses this station.
  EXPECT_THROW(Shipped("field", "nominal", {"stations.crafts=[[0,0]]"}), UserError);
}

}  // namespace
}  // namespace stg::env

// Directions that an AUV's own modem measures, in the joint filter: closed forms, and a truth that
// is drawn from its model.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "auv_common/numbers/attitude.hpp"
#include "localization/drifting_sea.hpp"
#include "stg_agent/localization/joint_filter.hpp"

namespace stg::agent {
namespace {

constexpr double kDeg = kPi / 180.0;

/// Without any error but those that a test asks for.
LocalizationConfig Exact() {
  LocalizationConfig c;
  c.late_share = 0.0;
  c.sound_speed_std = 0.0;
  return c;
}

/// A beacon to the east at a known place, at the depth of the AUV.
DirectionReading ToTheEast(double range_m, double std_rad) {
  DirectionReading z;
  z.source = 1;
  z.p_receiver = {0.0, 0.0, -40.0};
  z.p_source = {range_m, 0.0, -40.0};
  z.std_rad = std_rad;
  return z;
}

/// Of two independent deviations of the same number.
double Both(double a, double b) { return a * b / std::hypot(a, b); }

// One packet of one beacon places an AUV: range times deviation of the azimuth across the line of
// sight, and the deviation of the range along it.
TEST(Direction, WithARangeToOneBeaconItIsAFullFix) {
  constexpr double kStart_m = 30.0, kRange_m = 1000.0, kStd = 1.0 * kDeg, kHeading = 0.3 * kDeg;
  for (const double heading : {0.0, kHeading}) {
    JointFilter filter(Exact(), kStart_m, 1, {{1e-6, 0.0}}, 0, {}, {true, heading, 0.0});
    DirectionReading z = ToTheEast(kRange_m, kStd);
    z.azimuth_rad = 0.01;
    ASSERT_TRUE(filter.Take(z));
    RangeReading range;
    range.receiver = 0;
    range.source = 1;
    range.p_receiver = z.p_receiver;
    range.p_source = z.p_source;
    range.range_m = kRange_m;
    ASSERT_TRUE(filter.Take(range));
    const PlaneError e = filter.Error(0, 0);
    const double across = kRange_m * std::hypot(kStd, heading);
    EXPECT_NEAR(std::sqrt(e.yy), Both(kStart_m, across), 0.01 * across);
    EXPECT_NEAR(std::sqrt(e.xx), 1.0, 0.1);
    // The beacon is farther north than reckoned, so the AUV is farther south: e is reckoned less
    // true.
    const double share = kStart_m * kStart_m / (kStart_m * kStart_m + across * across);
    EXPECT_NEAR(e.y, 0.01 * kRange_m * share, 0.1);
  }
}

// The error of the heading is the same in all directions, so it does not become smaller.
TEST(Direction, ManyPacketsOfOneBeaconLeaveTheErrorOfTheHeading) {
  constexpr double kRange_m = 1000.0, kHeading = 0.3 * kDeg;
  LocalizationConfig c = Exact();
  JointFilter filter(c, 60.0, 1, {{1e-6, 0.0}}, 0, {}, {true, kHeading, 0.0});
  for (int k = 0; k < 1000; ++k) filter.Take(ToTheEast(kRange_m, 1.0 * kDeg));
  EXPECT_NEAR(std::sqrt(filter.Error(0, 0).yy), Both(60.0, kRange_m * kHeading), 0.1);
}

// Two beacons in different directions tell the error of the heading, and then the position.
TEST(Direction, TwoBeaconsTellTheHeading) {
  constexpr double kRange_m = 1000.0, kHeading = 1.0 * kDeg, kStd = 0.1 * kDeg;
  JointFilter filter(Exact(), 60.0, 1, {{1e-6, 0.0}, {1e-6, 0.0}}, 0, {}, {true, kHeading, 0.0});
  for (int k = 0; k < 4000; ++k) {
    DirectionReading z = ToTheEast(kRange_m, kStd);
    z.azimuth_rad = 0.01;
    filter.Take(z);
    z.source = 2;
    z.p_source.x = -kRange_m;
    z.azimuth_rad = kPi + 0.01;
    filter.Take(z);
  }
  // Both directions are turned by 0.01 rad, and the AUV is where it reckons.
  const PlaneError e = filter.Error(0, 0);
  EXPECT_NEAR(e.y, 0.0, 0.1);
  EXPECT_LT(std::sqrt(e.yy), 0.1);
}

// Of an AUV at depth d above a beacon, the elevation has the deviation r^2 b / d in the plane.
TEST(Direction, TheElevationTellsTheHorizontalDistance) {
  constexpr double kLevel_m = 300.0, kUp_m = 400.0, kStart_m = 10.0, kStd = 0.01;
  JointFilter filter(Exact(), kStart_m, 1, {{1e-6, 0.0}}, 0, {}, {true, 0.0, 0.0});
  DirectionReading z = ToTheEast(kLevel_m, kStd);
  z.p_source.z = z.p_receiver.z - kUp_m;
  z.elevation_rad = std::atan2(-kUp_m, kLevel_m + 5.0);
  ASSERT_TRUE(filter.Take(z));
  const PlaneError e = filter.Error(0, 0);
  const double range = std::hypot(kLevel_m, kUp_m);
  EXPECT_NEAR(std::sqrt(e.xx), Both(kStart_m, range * range * kStd / kUp_m), 0.05);
  // Across the line of sight the error of the head is a larger angle in the plane.
  EXPECT_NEAR(std::sqrt(e.yy), Both(kStart_m, range * kStd), 0.05);
  EXPECT_GT(e.x, 3.0) << "the beacon is farther away than reckoned";
}

TEST(Direction, StraightAboveOrBelowThereIsNone) {
  JointFilter filter(Exact(), 1.0, 1, {{1e-6, 0.0}}, 0, {}, {true, 0.0, 0.0});
  DirectionReading z = ToTheEast(1.0, 0.01);
  z.p_source.z = -500.0;
  z.elevation_rad = -0.5 * kPi;
  EXPECT_FALSE(filter.Take(z));
}

// The truth is drawn from the model of the filter. With one beacon, the error of all headings
// together remains: a turn of the picture around the beacon is in no range and no direction.
struct HeadJudgement {
  double rmse = 0.0, nees = 0.0, relative_nees = 0.0;
};

HeadJudgement JudgeHead(const DriftOptions& o, const char* what, int runs = 100) {
  DriftingSea sea(LocalizationConfig(), o);
  HeadJudgement j;
  for (int k = 0; k < runs; ++k) {
    const DriftResult r = sea.Run(9000U + static_cast<unsigned>(k));
    j.rmse += (r.error_x * r.error_x + r.error_y * r.error_y) / runs;
    j.nees += DriftResult::Nees(r.error_x, r.error_y, r.own) / runs;
    j.relative_nees += DriftResult::Nees(r.relative_x, r.relative_y, r.relative) / runs;
  }
  j.rmse = std::sqrt(j.rmse);
  std::printf("%-30s position %6.2f m, NEES %.2f; relative NEES %.2f\n", what, j.rmse, j.nees,
              j.relative_nees);
  return j;
}

DriftOptions OneBeacon(double head_deg, double heading_deg, double walk_deg_per_sqrt_h = 0.1) {
  DriftOptions o;
  o.beacons = 1;
  o.slot_s = 2.5;
  o.head_std_deg = head_deg;
  o.headings = {head_deg > 0.0, heading_deg * kDeg, walk_deg_per_sqrt_h * kDeg / 60.0};
  return o;
}

TEST(Direction, OneBeaconAndTheOwnHeadPlaceAnAuvConsistently) {
  const HeadJudgement none = JudgeHead(OneBeacon(0.0, 0.3), "1 beacon, no head");
  for (const double head : {0.3, 1.0}) {
    DriftOptions o = OneBeacon(head, 0.3);
    const HeadJudgement j = JudgeHead(o, head < 1.0 ? "head of 0.3 deg" : "head of 1 deg");
    EXPECT_LT(j.nees, 2.55);
    EXPECT_GT(j.nees, 1.52);
    EXPECT_LT(j.relative_nees, 2.55);
    EXPECT_LT(j.rmse, none.rmse);
    o.loss = 0.7;
    const HeadJudgement lossy = JudgeHead(o, "the same, 70 % lost");
    EXPECT_LT(lossy.nees, 2.55);
    EXPECT_GT(lossy.nees, 1.3);
  }
}

TEST(Direction, AmongThemselvesTheyTellNothingOfTheWorld) {
  DriftOptions o;
  o.headings = {true, 0.3 * kDeg, 0.1 * kDeg / 60.0};
  const DriftResult ranges = DriftingSea(LocalizationConfig(), o).Run(5);
  o.head_std_deg = 0.3;
  const DriftResult both = DriftingSea(LocalizationConfig(), o).Run(5);
  EXPECT_LT(both.relative.xx, ranges.relative.xx);
  EXPECT_NEAR(both.mean_error.xx / ranges.mean_error.xx, 1.0, 1e-3);
  EXPECT_NEAR(both.mean_error.yy / ranges.mean_error.yy, 1.0, 1e-3);
}

}  // namespace
}  // namespace stg::agent

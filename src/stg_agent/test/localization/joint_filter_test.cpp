// The joint filter of reckoned positions is as good as its model allows, and states no smaller
// error.

#include "stg_agent/localization/joint_filter.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "localization/drifting_sea.hpp"

namespace stg::agent {
namespace {

constexpr int kRuns = 100, kManyRuns = 200;
/// 99 % interval of chi-squared with two degrees of freedom per run, over the number of runs.
constexpr double kLower = 1.52, kUpper = 2.55, kManyLower = 1.66, kManyUpper = 2.38;

struct Judgement {
  int runs = 0;
  double rmse = 0.0, nees = 0.0, relative_rmse = 0.0, relative_nees = 0.0, current_nees = 0.0;
  double nis = 0.0, aside = 0.0;
};

Judgement Judge(const DriftOptions& o, const char* what, int runs = kRuns) {
  DriftingSea sea(LocalizationConfig(), o);
  Judgement j;
  j.runs = runs;
  for (int k = 0; k < runs; ++k) {
    const DriftResult r = sea.Run(4000U + static_cast<unsigned>(k));
    j.rmse += (r.error_x * r.error_x + r.error_y * r.error_y) / runs;
    j.nees += DriftResult::Nees(r.error_x, r.error_y, r.own) / runs;
    j.relative_rmse += (r.relative_x * r.relative_x + r.relative_y * r.relative_y) / runs;
    j.relative_nees += DriftResult::Nees(r.relative_x, r.relative_y, r.relative) / runs;
    j.current_nees += DriftResult::Nees(r.current_x, r.current_y, r.current) / runs;
    j.nis += r.nis / runs;
    j.aside += static_cast<double>(r.aside) / std::max(1, r.ranges + r.aside) / runs;
  }
  j.rmse = std::sqrt(j.rmse);
  j.relative_rmse = std::sqrt(j.relative_rmse);
  std::printf(
      "%-22s position %7.1f m, NEES %.2f; relative %5.2f m, %.2f; current %.2f; NIS %.3f, set "
      "aside %.4f\n",
      what, j.rmse, j.nees, j.relative_rmse, j.relative_nees, j.current_nees, j.nis, j.aside);
  return j;
}

void ExpectConsistent(const Judgement& j) {
  const double lower = j.runs == kRuns ? kLower : kManyLower;
  const double upper = j.runs == kRuns ? kUpper : kManyUpper;
  for (const double nees : {j.nees, j.relative_nees, j.current_nees}) {
    EXPECT_GT(nees, lower);
    EXPECT_LT(nees, upper);
  }
}

TEST(JointFilter, ACraftThatKnowsWhereItIsHoldsTheSwarm) {
  DriftOptions o;
  o.craft = true;
  const Judgement j = Judge(o, "craft");
  ExpectConsistent(j);
  EXPECT_LT(j.rmse, 4.5);
  EXPECT_LT(j.relative_rmse, 1.5);
  EXPECT_NEAR(j.nis, 1.0, 0.05);
}

TEST(JointFilter, TheCraftsBearingsPlaceTheSwarmBetter) {
  DriftOptions o;
  o.craft = true;
  o.craft_std_m = 0.5;
  const Judgement ranges = Judge(o, "craft of 0.5 m");
  ExpectConsistent(ranges);
  o.usbl_std_deg = 0.3;
  const Judgement both = Judge(o, "the same with USBL", kManyRuns);
  ExpectConsistent(both);
  EXPECT_LT(both.rmse, 0.9 * ranges.rmse);
  EXPECT_LT(both.rmse, 1.6);
  o.loss = 0.7;
  ExpectConsistent(Judge(o, "the same, 70 % lost", kManyRuns));
}

// A craft at a known place takes the bearing of an AUV whose position has deviation s. Across a
// line of sight of length r, the bearing leaves s r b / sqrt(s^2 + r^2 b^2).
TEST(JointFilter, ABearingLeavesWhatItsErrorIsAcrossTheLine) {
  constexpr double kStart_m = 10.0, kRange_m = 400.0, kStd = 0.01;
  JointFilter filter(LocalizationConfig(), kStart_m, 1, {{1e-6, 0.0}}, 0);
  BearingReading z;
  z.receiver = 1;
  z.source = 0;
  z.p_source = {kRange_m, 0.0, -40.0};
  z.azimuth_rad = 0.02;
  z.std_rad = kStd;
  ASSERT_TRUE(filter.Take(z));
  const PlaneError e = filter.Error(0, 0);
  const double across = kRange_m * kStd;
  EXPECT_NEAR(std::sqrt(e.yy), kStart_m * across / std::hypot(kStart_m, across), 0.01);
  EXPECT_NEAR(e.xx, kStart_m * kStart_m, 1e-6);
  // An error is reckoned less true. The AUV is farther north than it reckons.
  EXPECT_NEAR(e.y, -0.02 * kRange_m * kStart_m * kStart_m / (kStart_m * kStart_m + across * across),
              0.02);
}

// The position has deviation s, and the fix has deviation r. They leave s r / sqrt(s^2 + r^2). The
// estimate is s^2 / (s^2 + r^2) of what the fix says.
TEST(JointFilter, AFixLeavesWhatTwoSourcesLeave) {
  constexpr double kStart_m = 40.0, kFix_m = 3.0;
  JointFilter filter(LocalizationConfig(), kStart_m, 2, {{2.0, 600.0}}, 0);
  const double S = kStart_m * kStart_m + kFix_m * kFix_m;
  ASSERT_TRUE(filter.Take(FixReading{0, 0, 30.0, -20.0, kFix_m}));
  EXPECT_NEAR(filter.last_nis(), 0.5 * (900.0 + 400.0) / S, 1e-12);
  const PlaneError e = filter.Error(0, 0);
  EXPECT_NEAR(e.xx, kStart_m * kStart_m * kFix_m * kFix_m / S, 1e-9);
  EXPECT_NEAR(e.yy, e.xx, 1e-12);
  EXPECT_NEAR(e.xy, 0.0, 1e-12);
  EXPECT_NEAR(e.x, 30.0 * kStart_m * kStart_m / S, 1e-9);
  EXPECT_NEAR(e.y, -20.0 * kStart_m * kStart_m / S, 1e-9);
  // This tells nothing about the other AUV. Stations have no fixes.
  EXPECT_EQ(filter.Error(1, 0).xx, kStart_m * kStart_m);
  EXPECT_FALSE(filter.Take(FixReading{2, 0, 0.0, 0.0, kFix_m}));
}

// In one hour another AUV has three fixes. The test judges when the next fix is due. The bound of
// all ranges and fixes is 42 m then.
TEST(JointFilter, FixesOfOneAuvHoldTheSwarm) {
  DriftOptions o;
  o.fix_period_s = 900.0;
  const Judgement j = Judge(o, "a fix each 900 s", kManyRuns);
  for (const double nees : {j.nees, j.relative_nees}) {
    EXPECT_GT(nees, kManyLower);
    EXPECT_LT(nees, kManyUpper);
  }
  EXPECT_LT(j.current_nees, kManyUpper);
  EXPECT_LT(j.rmse, 1.3 * 42.0);
  EXPECT_LT(j.relative_rmse, 2.2);
  o.loss = 0.7;
  EXPECT_LT(Judge(o, "the same, 70 % lost").nees, kUpper);
}

// sigma^2(t) = P_ee - 2 t P_ec + t^2 P_cc + q t^3 / 3 + what log and heading add. After two fixes
// P_ec is known, too.
TEST(JointFilter, WhatComesIsTheGrowthOfTheErrorModel) {
  const LocalizationConfig c;
  JointFilter filter(c, 1.0, 1, {}, 0);
  filter.Take(FixReading{0, 0, 0.0, 0.0, 3.0});
  const double T = 600.0, t = 900.0;
  for (int s = 1; s <= 600; ++s) filter.Predict(s * TimeNs{1'000'000'000});
  const double before = filter.Error(0, filter.now()).xx;
  filter.Take(FixReading{0, filter.now(), -120.0, 60.0, 3.0});
  // Two fixes T apart measure e and e - T c, each with its own error.
  const double rate = c.current_std_mps * c.current_std_mps + c.shear_std_mps * c.shear_std_mps;
  EXPECT_NEAR(before, rate * T * T, 0.05 * rate * T * T);
  const double q = 2.0 * (c.current_std_mps * c.current_std_mps / c.current_memory_s +
                          c.shear_std_mps * c.shear_std_mps / c.shear_memory_s);
  const PlaneError now = filter.Error(0, filter.now()), one = filter.Ahead(0, t),
                   two = filter.Ahead(0, 2.0 * t);
  const double added = c.reckoning_std_m * c.reckoning_std_m;
  EXPECT_NEAR(filter.Ahead(0, 0.0).xx, now.xx, 1e-12);
  // Two times give the quadratic part. It must also hold at a third time.
  const auto square = [&](const PlaneError& e, double s) {
    return e.xx - q * s * s * s / 3.0 - added * s;
  };
  const double a = square(one, t) - now.xx, b = square(two, 2.0 * t) - now.xx;
  const double P_cc = (b - 2.0 * a) / (2.0 * t * t), P_ec = (4.0 * a - b) / (-4.0 * t);
  const PlaneError half = filter.Ahead(0, 0.5 * t);
  EXPECT_NEAR(square(half, 0.5 * t), now.xx - t * P_ec + 0.25 * t * t * P_cc, 1e-6 * half.xx);
  // Two errors remain in the current: that of the way between the fixes, and its change since then.
  const double known = (2.0 * 9.0 + added * T) / (T * T) + q * T / 3.0;
  EXPECT_NEAR(P_cc, known, 0.15 * known);
  // The AUV goes on as it went, with 0.2 m/s to the west and 0.1 m/s to the north.
  EXPECT_NEAR(one.x, -120.0 - 0.2 * t, 15.0);
  EXPECT_NEAR(one.y, 60.0 + 0.1 * t, 10.0);
}

TEST(JointFilter, BeaconsHoldTheSwarm) {
  DriftOptions o;
  o.slot_s = 2.5;
  o.beacons = 2;
  Judgement j = Judge(o, "2 beacons");
  ExpectConsistent(j);
  EXPECT_LT(j.rmse, 3.5);
  o.beacons = 1;
  j = Judge(o, "1 beacon");
  EXPECT_LT(j.nees, kUpper);
  EXPECT_LT(j.rmse, 14.0);
}

TEST(JointFilter, LostPacketsCostAccuracyAndNoHonesty) {
  DriftOptions o;
  o.craft = true;
  o.loss = 0.7;
  const Judgement j = Judge(o, "craft, 70 % lost");
  ExpectConsistent(j);
  EXPECT_LT(j.rmse, 7.0);
}

TEST(JointFilter, LateSoundsAreSetAside) {
  DriftOptions o;
  o.craft = true;
  o.late = 0.02;
  const Judgement j = Judge(o, "craft, 2 % late");
  EXPECT_LT(j.nees, kUpper);
  EXPECT_LT(j.rmse, 5.0);
  EXPECT_GT(j.aside, 0.01);
  EXPECT_LT(j.aside, 0.03);
}

TEST(JointFilter, ClocksThatAreOffAreEstimated) {
  DriftOptions o;
  o.craft = true;
  const Judgement right = Judge(o, "craft, right clocks");
  o.clocks = {false, 1e-4, 1e-6};
  const Judgement ignored = Judge(o, "clocks off by 1 ppm");
  EXPECT_GT(ignored.nees, 10.0);
  EXPECT_GT(ignored.nis + ignored.aside, 1.5);
  o.clocks.estimated = true;
  const Judgement j = Judge(o, "the same, estimated");
  ExpectConsistent(j);
  EXPECT_LT(j.rmse, 1.15 * right.rmse);
  EXPECT_LT(j.relative_rmse, 1.15 * right.relative_rmse);
  EXPECT_NEAR(j.nis, 1.0, 0.05);
  // A second is 1.5 km at first.
  o.clocks.offset_std_s = 1.0;
  const Judgement far = Judge(o, "off by a second");
  ExpectConsistent(far);
  EXPECT_LT(far.rmse, 1.15 * right.rmse);
  o.loss = 0.7;
  ExpectConsistent(Judge(o, "the same, 70 % lost"));
  o.loss = 0.0;
  o.craft = false;
  o.beacons = 2;
  o.slot_s = 2.5;
  const Judgement beacons = Judge(o, "2 beacons, off");
  EXPECT_LT(beacons.nees, kUpper);
  EXPECT_LT(beacons.rmse, 5.0);
}

TEST(JointFilter, AloneTheSwarmStatesTheDriftOfItsWater) {
  DriftOptions o;
  const Judgement j = Judge(o, "alone");
  ExpectConsistent(j);
  EXPECT_LT(j.relative_rmse, 2.2);
  // The mean error is the integral of the common current and of the mean of the four AUVs' own
  // ones.
  const auto V = [](double std, double memory, double t) {
    return 2.0 * std * std * memory * memory * (t / memory - 1.0 + std::exp(-t / memory));
  };
  const double variance = V(0.2, 43200.0, 3600.0) + V(0.1, 10800.0, 3600.0) / 4.0;
  const DriftResult r = DriftingSea(LocalizationConfig(), o).Run(1);
  EXPECT_NEAR(std::sqrt(r.mean_error.xx), std::sqrt(variance), 0.01 * std::sqrt(variance));
}

TEST(JointFilter, RangesAmongThemselvesTellNothingOfTheWorld) {
  DriftOptions o;
  const DriftResult with = DriftingSea(LocalizationConfig(), o).Run(5);
  o.ranges = false;
  const DriftResult without = DriftingSea(LocalizationConfig(), o).Run(5);
  EXPECT_LT(with.relative.xx, 1e-3 * without.relative.xx);
  EXPECT_NEAR(with.mean_error.xx / without.mean_error.xx, 1.0, 1e-6);
  EXPECT_NEAR(with.mean_error.yy / without.mean_error.yy, 1.0, 1e-6);
  EXPECT_NEAR(with.mean_error.x, without.mean_error.x, 1e-6);
  DriftOptions wrong = o;
  wrong.ranges = true;
  wrong.clocks = {true, 1e-4, 1e-6};
  const DriftResult clocks = DriftingSea(LocalizationConfig(), wrong).Run(5);
  EXPECT_NEAR(clocks.mean_error.xx / without.mean_error.xx, 1.0, 1e-6);
  EXPECT_LT(clocks.relative.xx, 1e-3 * without.relative.xx);
  // Ranges may tell C from the AUVs' own currents w. They do not tell what carries all AUVs.
  EXPECT_LE(with.current.xx, without.current.xx * (1.0 + 1e-9));
}

TEST(JointFilter, ADriftThatNobodySeesChangesNothing) {
  DriftOptions o;
  const DriftResult still = DriftingSea(LocalizationConfig(), o).Run(6);
  o.shift_m = 1000.0;
  o.drift_mps = 0.25;
  const DriftResult moved = DriftingSea(LocalizationConfig(), o).Run(6);
  EXPECT_NEAR(moved.own.x, still.own.x, 1e-5);
  EXPECT_NEAR(moved.own.xx, still.own.xx, 1e-5);
  EXPECT_NEAR(moved.relative.x, still.relative.x, 1e-5);
}

TEST(JointFilter, OfTooManyAuvsTheOneHeardLongestAgoIsForgotten) {
  JointFilter filter(LocalizationConfig(), 1.0, 12, {}, 3);
  EXPECT_TRUE(filter.knows(3));
  EXPECT_FALSE(filter.knows(11));
  filter.Predict(100'000'000'000);
  for (const int id : {0, 1, 2, 4, 5, 6}) filter.Admit(id, 99'000'000'000);
  filter.Admit(11, 100'000'000'000);
  EXPECT_TRUE(filter.knows(11));
  EXPECT_FALSE(filter.knows(7)) << "heard at the start only";
  EXPECT_TRUE(filter.knows(3)) << "the own one stays";
  // The new AUV came through the same water, so a part of its error is the same.
  const PlaneError apart = filter.Relative(11, 3, filter.now()),
                   own = filter.Error(3, filter.now());
  EXPECT_LT(apart.xx, own.xx);
  EXPECT_GT(apart.xx, 2.0 * 0.1 * 0.1 * 100.0 * 100.0 * 0.9);
}

}  // namespace
}  // namespace stg::agent

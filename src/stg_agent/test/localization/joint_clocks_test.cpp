// The clocks in the joint filter, by closed forms.

#include <gtest/gtest.h>

#include <vector>

#include "stg_agent/localization/joint_filter.hpp"

namespace stg::agent {
namespace {

// Of two members whose places are known, the range is that between them and s by which the clock of
// one is ahead. After a range with the noise r, s r / sqrt(s^2 + r^2) is left.
TEST(JointFilter, ARangeBetweenKnownPlacesReadsTheClock) {
  LocalizationConfig c;
  c.late_share = 0.0;
  c.sound_speed_std = 0.0;
  constexpr double kOffset_s = 0.01, kAhead_m = 20.0, kTime_s = 100.0, kRate = 1e-4;
  JointFilter filter(c, 1e-6, 1, {{1e-6, 0.0}}, 0, {true, kOffset_s, 0.0});
  RangeReading z;
  z.receiver = 0;
  z.source = 1;
  z.p_source = {400.0, 0.0, 0.0};
  z.range_m = 400.0 + kAhead_m;
  const double s = kOffset_s * kClockSound_mps * kClockSound_mps * kOffset_s;
  ASSERT_TRUE(filter.Take(z));
  EXPECT_NEAR(filter.last_nis(), kAhead_m * kAhead_m / (s + 1.0), 1e-6);
  ASSERT_TRUE(filter.Take(z));
  const double left = s / (s + 1.0), missing = kAhead_m / (s + 1.0);
  EXPECT_NEAR(filter.last_nis(), missing * missing / (left + 1.0), 1e-6);
  // In other water the same clock is another range ahead.
  JointFilter other(c, 1e-6, 1, {{1e-6, 0.0}}, 0, {true, kOffset_s, 0.0});
  z.sound_mps = 1450.0;
  const double share = 1450.0 / kClockSound_mps;
  ASSERT_TRUE(other.Take(z));
  EXPECT_NEAR(other.last_nis(), kAhead_m * kAhead_m / (share * share * s + 1.0), 1e-6);
  // A rate grows with the time; the filter gets no places that change.
  LocalizationConfig still = c;
  still.reckoning_std_m = 1e-9;
  still.current_std_mps = still.shear_std_mps = 1e-9;
  JointFilter late(still, 1e-6, 1, {{1e-6, 0.0}}, 0, {true, 0.0, kRate});
  late.Predict(static_cast<TimeNs>(kTime_s * 1e9));
  z.sound_mps = kClockSound_mps;
  z.at = late.now();
  ASSERT_TRUE(late.Take(z));
  const double grown = kRate * kTime_s * kClockSound_mps;
  EXPECT_NEAR(late.last_nis(), kAhead_m * kAhead_m / (grown * grown + 1.0), 1e-6);
  // Half as old a range, half as far ahead.
  JointFilter aged(still, 1e-6, 1, {{1e-6, 0.0}}, 0, {true, 0.0, kRate});
  aged.Predict(static_cast<TimeNs>(kTime_s * 1e9));
  z.at = aged.now() / 2;
  ASSERT_TRUE(aged.Take(z));
  EXPECT_NEAR(aged.last_nis(), kAhead_m * kAhead_m / (0.25 * grown * grown + 1.0), 1e-6);
}

// As many states as a network may have: a range to the last beacon is weighed like any other one.
TEST(JointFilter, TheLargestNetworkHasRoom) {
  constexpr int kAuvs = JointFilter::kMostObservers, kBeacons = 23;
  LocalizationConfig c;
  c.sound_speed_std = 0.0;
  const std::vector<AnchorModel> beacons(kBeacons, {1e-6, 0.0, false});
  JointFilter filter(c, 1e-6, kAuvs, beacons, 0, {true, 0.01, 0.0});
  RangeReading z;
  z.receiver = kAuvs - 1;
  z.source = kAuvs + kBeacons - 1;
  z.p_source = {400.0, 0.0, 0.0};
  z.range_m = 420.0;
  ASSERT_TRUE(filter.Take(z));
  const double clock = 0.01 * kClockSound_mps;
  EXPECT_NEAR(filter.last_nis(), 400.0 / (2.0 * clock * clock + 1.0), 1e-6);
  EXPECT_NEAR(filter.Error(kAuvs - 1, 0).xx, 1e-12, 1e-14);
}

}  // namespace
}  // namespace stg::agent

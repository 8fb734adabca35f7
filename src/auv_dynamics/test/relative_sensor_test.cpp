// Sensors of range and bearing: their statistics, their geometry, and the frame of what they tell.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "physics.hpp"

namespace stg::dynamics {
namespace {

const Vec3<double> kAt{10.0, -20.0, -40.0};
constexpr double kDegree = kPi / 180.0;

/// One AUV at rest below the origin, one target at r from it.
class RelativeSensorTest : public ::testing::Test {
 protected:
  RelativeSensorTest() {
    s_ = QuietScenario(1);
    s_.world.vehicle = ReleaseVehicle();
    s_.world.workspace.half_extent_m = 2000.0;
    s_.world.sea.open = true;
    s_.world.sensing.sensor = "range_bearing";
    s_.world.sensing.range_m = 600.0;
  }

  /// Takes `looks` detections, each with new random draws.
  std::vector<Detection> Look(const Vec3<double>& r, int looks) {
    std::vector<Detection> all;
    World world(s_);
    for (int lane = 0; lane < kLanes; ++lane) {
      world.Place(lane, {kAt}, {kAt + r}, {{0.0, 0.0, 0.0}});
    }
    for (int k = 0; k < looks; ++k) {
      Detection d;
      if (world.Sense(0, 0, 0, &d)) all.push_back(d);
      world.Step(NoForce(1));
    }
    return all;
  }

  WorldScenario s_;
};

struct Moments {
  double mean = 0.0, std = 0.0;
};
template <class Value>
Moments Of(const std::vector<Detection>& all, const Value& value) {
  Moments m;
  for (const Detection& d : all) m.mean += value(d) / static_cast<double>(all.size());
  for (const Detection& d : all) m.std += std::pow(value(d) - m.mean, 2);
  m.std = std::sqrt(m.std / static_cast<double>(all.size()));
  return m;
}

TEST_F(RelativeSensorTest, NoiseHasTheConfiguredMoments) {
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".range_std_m=2.0"});
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".range_std_share=0.02"});
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".bearing_std_deg=1.5"});
  const Vec3<double> r{120.0, -160.0, 0.0};  // 200 m
  const auto all = Look(r, 4000);
  ASSERT_EQ(all.size(), 4000U);
  const double n = std::sqrt(4000.0);
  const Moments range = Of(all, [](const Detection& d) { return d.range_m; });
  EXPECT_NEAR(range.mean, 200.0, 5.0 * 6.0 / n);
  EXPECT_NEAR(range.std, 6.0, 5.0 * 6.0 / (n * std::sqrt(2.0)));
  const Moments azimuth = Of(all, [](const Detection& d) { return d.azimuth_rad; });
  EXPECT_NEAR(azimuth.mean, std::atan2(-160.0, 120.0), 5.0 * 1.5 * kDegree / n);
  EXPECT_NEAR(azimuth.std, 1.5 * kDegree, 5.0 * 1.5 * kDegree / (n * std::sqrt(2.0)));
  const Moments elevation = Of(all, [](const Detection& d) { return d.elevation_rad; });
  EXPECT_NEAR(elevation.mean, 0.0, 5.0 * 1.5 * kDegree / n);
  EXPECT_NEAR(elevation.std, 1.5 * kDegree, 5.0 * 1.5 * kDegree / (n * std::sqrt(2.0)));
  EXPECT_NEAR(all[0].range_std_m, 2.0 + 0.02 * all[0].range_m, 1e-12);
  EXPECT_NEAR(all[0].bearing_std_rad, 1.5 * kDegree, 1e-12);
}

TEST_F(RelativeSensorTest, ProbabilityFallsWithTheSquareOfTheRangeToTheShareAtItsEnd) {
  s_.world.sensing.detection_probability = 0.8;
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".probability_at_range=0.25"});
  for (const double range : {60.0, 300.0, 599.0}) {
    const double share = range / 600.0;
    const double expected = 0.8 * (1.0 - 0.75 * share * share);
    const auto all = Look({range, 0.0, 0.0}, 3000);
    EXPECT_NEAR(static_cast<double>(all.size()), 3000.0 * expected,
                5.0 * std::sqrt(3000.0 * expected * (1.0 - expected)))
        << range;
  }
  EXPECT_TRUE(Look({601.0, 0.0, 0.0}, 100).empty());
}

TEST_F(RelativeSensorTest, OutliersAndFalseAlarmsAreUniformInRange) {
  s_.world.sensing.sensor = "range";
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".outlier_probability=0.2"});
  const auto far_off = [](const Detection& d) { return std::abs(d.range_m - 100.0) > 20.0; };
  int outliers = 0;
  for (const Detection& d : Look({100.0, 0.0, 0.0}, 3000)) outliers += far_off(d) ? 1 : 0;
  const double expected = 0.2 * (1.0 - 40.0 / 600.0);
  EXPECT_NEAR(outliers, 3000.0 * expected, 5.0 * std::sqrt(3000.0 * expected));

  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".outlier_probability=0.0"});
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".false_alarm_probability=0.3"});
  const auto alarms = Look({900.0, 0.0, 0.0}, 3000);  // no target is within range
  EXPECT_NEAR(static_cast<double>(alarms.size()), 900.0, 5.0 * std::sqrt(3000.0 * 0.21));
  EXPECT_NEAR(Of(alarms, [](const Detection& d) { return d.range_m; }).mean, 300.0,
              5.0 * 600.0 / std::sqrt(12.0 * 900.0));
}

TEST_F(RelativeSensorTest, LooksOnlyAtItsPeriod) {
  s_.world.sensing.period_s = 2.0;  // steps of 0.1 s
  const auto all = Look({100.0, 0.0, 0.0}, 101);
  ASSERT_EQ(all.size(), 6U);
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(all[k].stamp, static_cast<TimeNs>(k) * 2'000'000'000);
  }
}

TEST_F(RelativeSensorTest, FieldOfViewIsAConeAroundTheBow) {
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".field_of_view_deg=90.0"});
  const auto seen = [&](double azimuth_deg, double elevation_deg) {
    const double c = std::cos(elevation_deg * kDegree);
    return !Look({100.0 * c * std::cos(azimuth_deg * kDegree),
                  100.0 * c * std::sin(azimuth_deg * kDegree),
                  100.0 * std::sin(elevation_deg * kDegree)},
                 1)
                .empty();
  };
  EXPECT_TRUE(seen(0.0, 0.0));
  EXPECT_TRUE(seen(44.0, 0.0));
  EXPECT_FALSE(seen(46.0, 0.0));
  EXPECT_TRUE(seen(0.0, -44.0));
  EXPECT_FALSE(seen(40.0, -30.0));  // 48.4 degrees off the bow
  EXPECT_FALSE(seen(180.0, 0.0));
}

TEST_F(RelativeSensorTest, AnAmbiguousBearingNamesPortAndStarboardAlike) {
  s_.world.sensing.sensor = "bearing";
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".ambiguous=true"});
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".bearing_std_deg=0.001"});
  for (const double azimuth_deg : {30.0, -30.0}) {  // the bow points east
    const Detection d = Look({100.0 * std::cos(azimuth_deg * kDegree),
                              100.0 * std::sin(azimuth_deg * kDegree), 0.0},
                             1)
                            .at(0);
    EXPECT_TRUE(d.ambiguous);
    EXPECT_NEAR(d.azimuth_rad, 30.0 * kDegree, 1e-3);
    EXPECT_NEAR(d.mirror_azimuth_rad, -30.0 * kDegree, 1e-3);
    EXPECT_EQ(d.kind, MeasurementKind::kBearing);
    EXPECT_EQ(Norm(d.p_WT - d.p_WO), 0.0);
  }
}

TEST_F(RelativeSensorTest, TellsInTheFrameOfItsOwnNavigation) {
  s_.world.navigation.kind = "dead_reckoning";
  s_.world.navigation.heading_std_deg = 10.0;
  s_.world.navigation.start_std_m = 30.0;
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".range_std_m=1e-9"});
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".range_std_share=0.0"});
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".bearing_std_deg=1e-9"});
  const Vec3<double> r{120.0, -160.0, 20.0};
  for (const char* sensor : {"position", "range_bearing"}) {
    s_.world.sensing.sensor = sensor;
    World world(s_);
    world.Place(0, {kAt}, {kAt + r}, {{0.0, 0.0, 0.0}});
    const NavState nav = world.Nav(0, 0);
    ASSERT_GT(Norm(nav.p_WB - kAt), 1.0);
    Detection d;
    ASSERT_TRUE(world.Sense(0, 0, 0, &d));
    EXPECT_LT(Norm(d.p_WO - nav.p_WB), 1e-12);
    EXPECT_EQ(d.p_WO_std_m, nav.position_std_m);
    // At rest the true attitude is level and east. The stated one differs by the heading's error.
    const Vec3<double> sent = RotationOf(nav.q_WB) * r + nav.p_WB;
    EXPECT_LT(Norm(d.p_WT - sent), 1e-6) << sensor;
  }
}

TEST_F(RelativeSensorTest, ARepeatedLookSeesTheSame) {
  config::Override(&s_, {"sensing." + s_.world.sensing.sensor + ".outlier_probability=0.5"});
  World world(s_);
  for (int lane = 0; lane < kLanes; ++lane) {
    world.Place(lane, {kAt}, {kAt + Vec3<double>{100.0, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
  }
  for (int k = 0; k < 50; ++k) {
    Detection a, b;
    ASSERT_TRUE(world.Sense(0, 0, 0, &a));
    ASSERT_TRUE(world.Sense(0, 0, 0, &b));
    EXPECT_EQ(a.range_m, b.range_m);
    EXPECT_EQ(a.azimuth_rad, b.azimuth_rad);
    world.Step(NoForce(1));
  }
}

TEST_F(RelativeSensorTest, APeriodThatIsNoWholeNumberOfDecisionsIsRefused) {
  s_.world.sensing.period_s = 0.25;
  EXPECT_THROW(World{s_}, UserError);
}

TEST_F(RelativeSensorTest, UnlabelledDetectionsAndTheirOrderDoNotTellTheTarget) {
  s_.run.agents = 3;
  config::Override(&s_, {"target.count=3", "sensing.labelled=false", "sensing.sensor=range",
                         "sensing.range.range_std_m=1e-9", "sensing.range.range_std_share=0"});
  std::vector<Vec3<double>> places{kAt + Vec3<double>{-200.0, 0.0, 0.0},
                                   kAt + Vec3<double>{100.0, 0.0, 0.0},
                                   kAt + Vec3<double>{300.0, 0.0, 0.0}};
  const auto before = [](const Vec3<double>& a, const Vec3<double>& b) { return a.x < b.x; };
  do {
    World world(s_);
    for (int lane = 0; lane < kLanes; ++lane) {
      world.Place(lane, {kAt, kAt, kAt}, places, {{}, {}, {}});
    }
    std::vector<Detection> all;
    world.SenseTargets(0, 0, [&all](const Detection& d) { all.push_back(d); });
    ASSERT_EQ(all.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(all[k].target, kUnlabelled);
      EXPECT_NEAR(all[k].range_m, 100.0 * static_cast<double>(k + 1), 1e-6);
    }
  } while (std::next_permutation(places.begin(), places.end(), before));
}

}  // namespace
}  // namespace stg::dynamics

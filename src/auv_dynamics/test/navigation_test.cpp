// Compares dead reckoning with the closed forms of its error model, over many episodes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "physics.hpp"

namespace stg::dynamics {
namespace {

/// Open water, a vehicle that moves as commanded, and dead reckoning without errors.
WorldScenario DriftScenario() {
  WorldScenario s = QuietScenario(1);
  s.world.vehicle.model = "kinematic";
  s.world.vehicle.max_velocity_mps = {2.0, 0.5, 0.5};
  s.world.vehicle.kinematic.min_speed_mps = 0.0;
  s.world.vehicle.kinematic.speed_lag_s = 0.1;
  s.world.workspace.half_extent_m = 5000.0;
  s.world.reset.start_half_extent_m = 5000.0;
  s.world.sea.open = true;
  s.world.sea.bottom_m = 120.0;
  NavigationConfig& n = s.world.navigation;
  n.kind = "dead_reckoning";
  n.dvl_scale_std = n.dvl_noise_mps = n.heading_std_deg = n.gyro_walk_deg_per_sqrt_h = 0.0;
  n.depth_std_m = n.start_std_m = n.current_std_mps = 0.0;
  return s;
}

/// Horizontal error along and across the way, and the stated error, of every episode.
struct Drift {
  std::vector<double> along, across, stated, squared;  ///< squared: error over variance, 2 numbers
  double distance_m = 0.0;
};

double Rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Flies `seconds` at 2 m/s with a given turn rate, in `rounds` times kLanes episodes.
Drift Fly(const WorldScenario& s, double seconds, double turn_radps, int rounds,
          double depth = 40.0) {
  Drift drift;
  World world(s);
  const auto steps = static_cast<int>(std::lround(seconds / s.run.time.dt_s));
  for (int round = 0; round < rounds; ++round) {
    for (int lane = 0; lane < kLanes; ++lane) {
      world.Reset(lane, static_cast<std::uint64_t>(1000 + round * kLanes + lane), 0,
                  ResetStage::kMedium);
    }
    VehicleState<Pack>& v = world.mutable_vehicle(0);
    v.p_WB.z = Pack(-depth);
    const Vec3<Pack> start = v.p_WB;
    const std::vector<Pack> command{Pack(2.0), Pack(turn_radps), Pack(0.0)};
    for (int k = 0; k < steps; ++k) world.Step(command);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec3<double> p_WB = Lane(world.vehicle(0).p_WB, lane), way = p_WB - Lane(start, lane);
      const NavState nav = world.Nav(lane, 0);
      const Vec3<double> error = nav.p_WB - p_WB;
      const double length = std::max(1e-9, std::hypot(way.x, way.y));
      drift.along.push_back((error.x * way.x + error.y * way.y) / length);
      drift.across.push_back((error.y * way.x - error.x * way.y) / length);
      drift.stated.push_back(nav.position_std_m);
      drift.squared.push_back((error.x * error.x + error.y * error.y) /
                              (nav.position_std_m * nav.position_std_m));
      drift.distance_m = length;
    }
  }
  return drift;
}

constexpr int kRounds = 100;
/// Five standard deviations of a standard deviation that kRounds * kLanes episodes estimate.
double Tolerance(double std) { return 5.0 * std / std::sqrt(2.0 * kRounds * kLanes); }

TEST(DeadReckoning, WithoutErrorsItIsTheTruth) {
  const Drift drift = Fly(DriftScenario(), 100.0, 0.02, 1);
  for (std::size_t e = 0; e < drift.along.size(); ++e) {
    EXPECT_NEAR(drift.along[e], 0.0, 1e-9);
    EXPECT_NEAR(drift.across[e], 0.0, 1e-9);
    EXPECT_EQ(drift.stated[e], 0.0);
  }
}

TEST(DeadReckoning, ScaleErrorGrowsWithTheDistanceAlongTheWay) {
  WorldScenario s = DriftScenario();
  s.world.navigation.dvl_scale_std = 0.01;
  for (const double seconds : {100.0, 400.0}) {
    const Drift drift = Fly(s, seconds, 0.0, kRounds);
    const double expected = 0.01 * drift.distance_m;
    EXPECT_NEAR(Rms(drift.along), expected, Tolerance(expected));
    EXPECT_LT(Rms(drift.across), 1e-6 * drift.distance_m);
    EXPECT_NEAR(drift.stated.front(), expected, 0.05 * expected);
  }
}

TEST(DeadReckoning, HeadingErrorTurnsTheWay) {
  WorldScenario s = DriftScenario();
  s.world.navigation.heading_std_deg = 0.5;
  const Drift drift = Fly(s, 400.0, 0.0, kRounds);
  const double expected = 0.5 * kPi / 180.0 * drift.distance_m;
  EXPECT_NEAR(Rms(drift.across), expected, Tolerance(expected));
  EXPECT_NEAR(drift.stated.front(), expected, 0.05 * expected);
  World world(s);
  world.Reset(0, 3, 0, ResetStage::kMedium);
  const NavState nav = world.Nav(0, 0), truth = world.Truth(0, 0);
  const double yaw =
      2.0 * std::atan2(nav.q_WB[3], nav.q_WB[0]) - 2.0 * std::atan2(truth.q_WB[3], truth.q_WB[0]);
  EXPECT_GT(std::abs(yaw), 1e-6);
  EXPECT_LT(std::abs(yaw), 5.0 * 0.5 * kPi / 180.0);
  EXPECT_NEAR(nav.heading_std_rad, 0.5 * kPi / 180.0, 1e-12);
}

TEST(DeadReckoning, NoiseOfPingsIsARandomWalk) {
  WorldScenario s = DriftScenario();
  s.world.navigation.dvl_noise_mps = 0.05;
  s.world.navigation.period_s = 2.0;
  const Drift drift = Fly(s, 400.0, 0.01, kRounds);
  const double expected = 0.05 * 2.0 * std::sqrt(200.0);
  EXPECT_NEAR(Rms(drift.along), expected, Tolerance(expected));
  EXPECT_NEAR(Rms(drift.across), expected, Tolerance(expected));
  EXPECT_NEAR(drift.stated.front(), expected, 1e-9);
}

TEST(DeadReckoning, GyroWalkGrowsWithThePowerThreeHalvesOfTime) {
  WorldScenario s = DriftScenario();
  s.world.navigation.gyro_walk_deg_per_sqrt_h = 2.0;
  const Drift drift = Fly(s, 400.0, 0.0, kRounds);
  // The error is the speed times the integral of the heading's Wiener process: q v T^(3/2) /
  // sqrt(3).
  const double expected = 2.0 * kPi / 180.0 / 60.0 * 2.0 * std::pow(400.0, 1.5) / std::sqrt(3.0);
  EXPECT_NEAR(Rms(drift.across), expected, Tolerance(expected) + 0.01 * expected);
  EXPECT_NEAR(drift.stated.front(), expected, 0.02 * expected);
}

TEST(DeadReckoning, AFixThatIsToldComesOnceForEachTimeAtTheSurface) {
  WorldScenario s = DriftScenario();
  s.world.navigation.start_std_m = 50.0;
  s.world.navigation.fixes = FixUse::kReported;
  const double dt = s.run.time.dt_s;
  const auto steps = [dt](double seconds) { return static_cast<int>(std::lround(seconds / dt)); };
  const std::vector<Pack> ahead{Pack(2.0), Pack(0.0), Pack(0.0)};
  World world(s);
  std::vector<double> errors;
  for (int round = 0; round < kRounds; ++round) {
    for (int lane = 0; lane < kLanes; ++lane) {
      world.Reset(lane, static_cast<std::uint64_t>(2000 + round * kLanes + lane), 0,
                  ResetStage::kMedium);
    }
    Vec3<Pack>& p_WB = world.mutable_vehicle(0).p_WB;
    p_WB.z = Pack(-40.0);
    for (int k = 0; k < steps(40.0); ++k) world.Step(ahead);
    EXPECT_EQ(world.Nav(0, 0).fix_std_m, 0.0);
    const Vec3<double> off = world.Nav(0, 0).p_WB - world.Truth(0, 0).p_WB;
    p_WB.z = Pack(-0.1);
    for (int k = 0; k < steps(30.0); ++k) world.Step(ahead);
    EXPECT_EQ(world.Nav(0, 0).fix_std_m, 0.0);
    for (int k = 0; k < steps(1.0); ++k) world.Step(ahead);
    for (int lane = 0; lane < kLanes; ++lane) {
      const NavState nav = world.Nav(lane, 0);
      const Vec3<double> truth = Lane(p_WB, lane);
      ASSERT_EQ(nav.fix_stamp, 71'000'000'000);
      EXPECT_EQ(nav.fix_std_m, 3.0);
      errors.push_back(nav.p_WF.x - truth.x);
      errors.push_back(nav.p_WF.y - truth.y);
    }
    if (round > 0) continue;
    // The vehicle keeps this fix for ten minutes, or until it has dived.
    for (int k = 0; k < steps(599.0); ++k) world.Step(ahead);
    EXPECT_EQ(world.Nav(0, 0).fix_stamp, 71'000'000'000);
    for (int k = 0; k < steps(1.0); ++k) world.Step(ahead);
    EXPECT_EQ(world.Nav(0, 0).fix_stamp, 671'000'000'000);
    p_WB.z = Pack(-5.0);
    for (int k = 0; k < steps(10.0); ++k) world.Step(ahead);
    p_WB.z = Pack(-0.1);
    for (int k = 0; k < steps(31.0); ++k) world.Step(ahead);
    EXPECT_EQ(world.Nav(0, 0).fix_stamp, 712'000'000'000);
    // No fix has corrected the position that navigation reckons.
    const Vec3<double> still = world.Nav(0, 0).p_WB - world.Truth(0, 0).p_WB;
    EXPECT_NEAR(still.x, off.x, 1e-9);
    EXPECT_NEAR(still.y, off.y, 1e-9);
  }
  EXPECT_NEAR(Rms(errors), 3.0, Tolerance(3.0));
}

TEST(DeadReckoning, CurrentDriftsItWhereTheLogHasNoBottom) {
  WorldScenario s = DriftScenario();
  s.world.current.velocity_mps = {0.2, 0.0, 0.0};
  s.world.navigation.current_std_mps = 0.2;
  const auto drifted = [&](double altitude_m) {
    s.world.navigation.dvl_altitude_m = altitude_m;
    return Fly(s, 100.0, 0.02, 1);
  };
  const Drift over_ground = drifted(100.0), in_water = drifted(50.0);
  EXPECT_NEAR(std::hypot(over_ground.along[0], over_ground.across[0]), 0.0, 1e-9);
  // The first ping of the log, at 1 s, shows that there is no bottom. The drift lasts from then on.
  EXPECT_NEAR(std::hypot(in_water.along[0], in_water.across[0]), 0.2 * 99.0, 1e-9);
  EXPECT_NEAR(in_water.stated[0], 0.2 * 99.0, 1e-9);
}

TEST(DeadReckoning, AFixAtTheSurfaceBoundsTheError) {
  WorldScenario s = DriftScenario();
  s.world.navigation.start_std_m = 100.0;
  s.world.navigation.gps_std_m = 3.0;
  const Drift drift = Fly(s, 10.0, 0.0, kRounds, 0.1);
  // Ten fixes of 3 m and the prior of 100 m.
  const double expected = 1.0 / std::sqrt(10.0 / 9.0 + 1e-4);
  EXPECT_NEAR(Rms(drift.along), expected, Tolerance(expected));
  EXPECT_NEAR(drift.stated.front(), expected, 1e-9);
  EXPECT_NEAR(Fly(s, 10.0, 0.0, 1, 5.0).stated.front(), 100.0, 1e-9);
}

TEST(DeadReckoning, DepthIsThePressureGauges) {
  WorldScenario s = DriftScenario();
  s.world.navigation.depth_std_m = 0.2;
  s.world.navigation.gps_std_m = 3.0;
  World world(s);
  std::vector<double> errors;
  for (int k = 0; k < 500; ++k) {
    for (int lane = 0; lane < kLanes; ++lane) {
      world.Reset(lane, static_cast<std::uint64_t>(k * kLanes + lane), 0, ResetStage::kMedium);
      errors.push_back(world.Nav(lane, 0).p_WB.z - world.Truth(lane, 0).p_WB.z);
    }
  }
  EXPECT_NEAR(Rms(errors), 0.2, 5.0 * 0.2 / std::sqrt(2.0 * 500 * kLanes));
}

TEST(DeadReckoning, StatesWhatItIsOffBy) {
  // All errors act at once, on a straight way and in circles. The stated deviation is the one of
  // the worst direction, so the mean squared error over its square is at most two.
  WorldScenario s = DriftScenario();
  NavigationConfig defaults;
  defaults.kind = "dead_reckoning";
  s.world.navigation = defaults;
  const double deviations = 5.0 * 2.0 / std::sqrt(static_cast<double>(kRounds * kLanes));
  for (const double turn : {0.0, 0.02}) {
    const Drift drift = Fly(s, 1000.0, turn, kRounds);
    double mean = 0.0;
    for (const double d : drift.squared) mean += d / static_cast<double>(drift.squared.size());
    EXPECT_LT(mean, 2.0 + deviations) << turn;
    EXPECT_GT(mean, 0.8) << turn;
  }
}

TEST(DeadReckoning, VelocityIsThatOfThePosition) {
  WorldScenario s = DriftScenario();
  NavigationConfig defaults;
  defaults.kind = "dead_reckoning";
  s.world.navigation = defaults;
  World world(s);
  for (int lane = 0; lane < kLanes; ++lane) world.Reset(lane, 5, 0, ResetStage::kMedium);
  const std::vector<Pack> command{Pack(2.0), Pack(0.0), Pack(0.0)};
  for (int k = 0; k < 95; ++k) world.Step(command);
  const NavState a = world.Nav(0, 0);
  world.Step(command);
  const NavState b = world.Nav(0, 0);
  const Vec3<double> v_W = RotationOf(b.q_WB) * b.v_WB_B;
  EXPECT_NEAR(v_W.x, (b.p_WB.x - a.p_WB.x) / s.run.time.dt_s, 1e-6);
  EXPECT_NEAR(v_W.y, (b.p_WB.y - a.p_WB.y) / s.run.time.dt_s, 1e-6);
}

TEST(DeadReckoning, LanesAreEpisodesOfTheirOwn) {
  WorldScenario s = DriftScenario();
  NavigationConfig defaults;
  defaults.kind = "dead_reckoning";
  s.world.navigation = defaults;
  World together(s), alone(s);
  const std::vector<Pack> command{Pack(2.0), Pack(0.05), Pack(0.1)};
  for (int lane = 0; lane < kLanes; ++lane) together.Reset(lane, 7, 0, ResetStage::kMedium);
  for (int k = 0; k < 33; ++k) together.Step(command);
  together.Reset(0, 11, 2, ResetStage::kMedium);  // the other lanes are between two pings
  for (int k = 0; k < 57; ++k) together.Step(command);
  for (int lane = 0; lane < kLanes; ++lane) alone.Reset(lane, 11, 2, ResetStage::kMedium);
  for (int k = 0; k < 57; ++k) alone.Step(command);
  const NavState a = together.Nav(0, 0), b = alone.Nav(0, 0);
  EXPECT_EQ(Norm(a.p_WB - b.p_WB), 0.0);
  EXPECT_EQ(Norm(a.v_WB_B - b.v_WB_B), 0.0);
  EXPECT_EQ(a.position_std_m, b.position_std_m);
}

TEST(PerfectNavigation, TellsTheTruth) {
  World world(QuietScenario(2));
  for (int lane = 0; lane < kLanes; ++lane) world.Reset(lane, 1, 0, ResetStage::kMedium);
  world.Step(NoForce(2));
  const NavState nav = world.Nav(0, 1), truth = world.Truth(0, 1);
  EXPECT_EQ(Norm(nav.p_WB - truth.p_WB), 0.0);
  EXPECT_EQ(nav.position_std_m, 0.0);
  EXPECT_EQ(nav.heading_std_rad, 0.0);
}

}  // namespace
}  // namespace stg::dynamics

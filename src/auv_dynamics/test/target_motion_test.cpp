#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "auv_common/config/loader.hpp"
#include "auv_common/numbers/random.hpp"
#include "physics.hpp"

namespace stg::dynamics {
namespace {

WorldScenario TargetScenario(const std::string& motion) {
  WorldScenario s = QuietScenario(1);
  s.world.target.motion = motion;
  s.world.vehicle = ReleaseVehicle();
  return s;
}

double AngleBetween(const Vec3<double>& a, const Vec3<double>& b) {
  return std::atan2(Norm(Cross(a, b)), Dot(a, b));
}

TEST(TargetMotion, ConstantVelocityMovesByVelocityTimesTime) {
  World world(TargetScenario("constant_velocity"));
  world.Place(0, {{0.0, 0.0, 0.0}}, {{0.1, -0.2, 0.3}}, {{0.01, 0.004, -0.006}});
  for (int k = 0; k < 200; ++k) world.Step(NoForce(1));
  const Vec3<double> p = Lane(world.target(0).p_WT, 0);
  EXPECT_NEAR(p.x, 0.3, 1e-13);
  EXPECT_NEAR(p.y, -0.12, 1e-13);
  EXPECT_NEAR(p.z, 0.18, 1e-13);
}

TEST(TargetMotion, ReflectionClampsAndFlipsThatComponentOnly) {
  World world(TargetScenario("constant_velocity"));
  world.Place(0, {{0.0, 0.0, 0.0}}, {{0.9995, -0.5, -0.9999}}, {{0.01, 0.02, -0.005}});
  world.Step(NoForce(1));
  const Vec3<double> p = Lane(world.target(0).p_WT, 0), v = Lane(world.target(0).v_WT, 0);
  EXPECT_EQ(p.x, 1.0);
  EXPECT_NEAR(p.y, -0.498, 1e-15);
  EXPECT_EQ(p.z, -1.0);
  EXPECT_EQ(v.x, -0.01);
  EXPECT_EQ(v.y, 0.02);
  EXPECT_EQ(v.z, 0.005);
  world.Step(NoForce(1));
  EXPECT_NEAR(Lane(world.target(0).p_WT, 0).x, 0.999, 1e-15);
  EXPECT_EQ(Lane(world.target(0).v_WT, 0).x, -0.01);
}

/// Steps `world` and checks every lane's target against its limits.
void CheckLimits(const WorldScenario& scenario, World* world, int steps) {
  const double most = scenario.world.target.max_turn_rate_radps * scenario.run.time.dt_s;
  const double dt = scenario.run.time.dt_s;
  std::array<Vec3<double>, static_cast<size_t>(kLanes)> p, v;
  const auto read = [&] {
    for (int l = 0; l < kLanes; ++l) {
      p[static_cast<size_t>(l)] = Lane(world->target(0).p_WT, l);
      v[static_cast<size_t>(l)] = Lane(world->target(0).v_WT, l);
    }
  };
  read();
  for (int k = 0; k < steps; ++k) {
    const auto p0 = p, v0 = v;
    world->Step(NoForce(world->agents()));
    read();
    for (size_t l = 0; l < static_cast<size_t>(kLanes); ++l) {
      ASSERT_NEAR(Norm(v[l]), Norm(v0[l]), 1e-12) << "step " << k;  // no motion changes the speed
      ASSERT_LE(Norm(v[l]), scenario.world.target.max_speed_mps * (1.0 + 1e-9));
      ASSERT_LE(AngleBetween(v[l], v0[l]), most * (1.0 + 1e-9) + 1e-12) << "step " << k;
      ASSERT_LE(Norm(p[l] - p0[l]), Norm(v[l]) * dt * (1.0 + 1e-9));
      const double e = scenario.world.workspace.half_extent_m;
      ASSERT_TRUE(std::abs(p[l].x) <= e && std::abs(p[l].y) <= e && std::abs(p[l].z) <= e);
    }
  }
}

TEST(TargetMotion, EveryMotionStaysWithinSpeedTurnRateAndWorkspace) {
  for (const std::string motion : {"coordinated_turn", "legs", "random_waypoint", "evasive"}) {
    WorldScenario scenario = TargetScenario(motion);
    // The reset stage may start it this fast. It then meets every wall.
    scenario.world.reset.stages[2].target_speed_mps = {0.01, 0.05};
    if (motion == "evasive") config::Override(&scenario, {"target.evasive.range_m=1"});
    World world(scenario);
    for (int n = 0; n < 6; ++n) {
      for (int l = 0; l < kLanes; ++l) {
        world.Reset(l, static_cast<std::uint64_t>(100 * n + l), 0, ResetStage::kHard);
      }
      CheckLimits(scenario, &world, 10000);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(TargetMotion, CoordinatedTurnTurnsAtTheStatedMeanRate) {
  WorldScenario scenario = TargetScenario("coordinated_turn");
  config::Override(&scenario, {"target.coordinated_turn.period_s=1"});
  scenario.world.workspace.half_extent_m = 100.0;  // no wall interferes
  World world(scenario);
  world.Reset(0, 3, 0, ResetStage::kMedium);
  double turned = 0.0;
  constexpr int kSteps = 40000;
  for (int k = 0; k < kSteps; ++k) {
    const Vec3<double> before = Lane(world.target(0).v_WT, 0);
    world.Step(NoForce(1));
    turned += AngleBetween(before, Lane(world.target(0).v_WT, 0));
  }
  // The 4000 rates are uniform in [0, 0.2] rad/s. The test allows five deviations.
  EXPECT_NEAR(turned / (0.1 * kSteps), 0.1, 5.0 * 0.2 / std::sqrt(12.0 * 4000.0));
}

/// Legs of 5 s without walls, with turns of 0.3 rad; overrides replace these numbers.
WorldScenario LegsScenario(const std::vector<std::string>& overrides = {}) {
  WorldScenario scenario = TargetScenario("legs");
  config::Override(&scenario, {"target.legs.duration_s=[5, 5]", "target.legs.turn_rad=[0.3, 0.3]"});
  config::Override(&scenario, overrides);
  scenario.world.workspace.half_extent_m = 100.0;  // no wall interferes
  return scenario;
}

TEST(TargetMotion, LegsAreStraightAndAFixedTurnApart) {
  World world(LegsScenario());
  world.Reset(0, 3, 0, ResetStage::kMedium);
  int port = 0, turns = 0;
  Vec3<double> axis{};
  for (int leg = 0; leg < 200; ++leg) {
    const Vec3<double> before = Lane(world.target(0).v_WT, 0);
    // The first step of a leg begins its turn; with 0.5 rad/s the turn takes 0.6 s of 5 s.
    for (int k = 0; k < 10; ++k) world.Step(NoForce(1));
    const Vec3<double> after = Lane(world.target(0).v_WT, 0);
    EXPECT_NEAR(AngleBetween(before, after), leg == 0 ? 0.0 : 0.3, 1e-9) << leg;
    for (int k = 10; k < 50; ++k) {
      world.Step(NoForce(1));
      ASSERT_EQ(Norm(Lane(world.target(0).v_WT, 0) - after), 0.0) << leg;
    }
    const Vec3<double> turned = Cross(before, after);
    if (leg > 1) port += Dot(axis, turned) > 0.0 ? 1 : 0;
    axis = turned;
    ++turns;
  }
  EXPECT_EQ(turns, 200);
  EXPECT_GT(port, 60);  // axes are drawn at random: half of them point to each side
  EXPECT_LT(port, 140);
}

TEST(TargetMotion, LegsLastAsLongAsStatedAndTurnToBothSidesInOpenWater) {
  WorldScenario scenario =
      LegsScenario({"target.legs.duration_s=[4, 8]", "target.legs.turn_rad=[0.2, 0.4]"});
  scenario.world.sea.open = true;
  World world(scenario);
  world.Place(0, {{0.0, 0.0, -30.0}}, {{10.0, 0.0, -30.0}}, {{0.01, 0.0, 0.0}});
  int legs = 0, port = 0;
  double turned = 0.0;
  bool turning = false;
  constexpr int kSteps = 60000;  // 6000 s
  for (int k = 0; k < kSteps; ++k) {
    const Vec3<double> before = Lane(world.target(0).v_WT, 0);
    world.Step(NoForce(1));
    const Vec3<double> after = Lane(world.target(0).v_WT, 0);
    EXPECT_EQ(after.z, 0.0);
    const double angle = AngleBetween(before, after);
    turned += angle;
    if (angle > 1e-9 && !turning) {
      ++legs;
      port += Cross(before, after).z > 0.0 ? 1 : 0;
    }
    turning = angle > 1e-9;
  }
  // Mean of 6 s, deviation 4 / sqrt(12) s, and a step of 0.1 s to end in: five deviations.
  EXPECT_NEAR(legs, 6000.0 / 6.05, 5.0 * std::sqrt(1000.0) * 1.155 / 6.0);
  EXPECT_NEAR(turned / legs, 0.3, 5.0 * 0.2 / std::sqrt(12.0 * 1000.0));
  EXPECT_NEAR(port, legs / 2.0, 5.0 * std::sqrt(legs / 4.0));
}

TEST(TargetMotion, TheCourseOfALegWalksAsStated) {
  WorldScenario scenario = LegsScenario(
      {"target.legs.duration_s=[1000, 1000]", "target.legs.course_walk_rad_per_sqrt_s=0.02"});
  World world(scenario);
  double square = 0.0;
  constexpr int kEpisodes = 400;
  for (int n = 0; n < kEpisodes; ++n) {
    world.Reset(0, static_cast<std::uint64_t>(n), 0, ResetStage::kMedium);
    const Vec3<double> before = Lane(world.target(0).v_WT, 0);
    for (int k = 0; k < 100; ++k) world.Step(NoForce(1));
    const double angle = AngleBetween(before, Lane(world.target(0).v_WT, 0));
    square += angle * angle / kEpisodes;
  }
  // 10 s: a variance of 0.02^2 * 10; the deviation of a variance of 400 values is sqrt(2 / 400).
  EXPECT_NEAR(square, 0.004, 5.0 * 0.004 * std::sqrt(2.0 / kEpisodes));
}

TEST(TargetMotion, EvasiveTargetTurnsAwayFromAnAuvInRange) {
  for (const Vec3<double>& auv : {Vec3<double>{0.06, 0.0, 0.0}, Vec3<double>{-0.03, 0.05, 0.0},
                                  Vec3<double>{0.01, -0.02, -0.06}}) {
    WorldScenario scenario = TargetScenario("evasive");
    World world(scenario);
    const Vec3<double> towards = auv * (0.01 / Norm(auv));
    world.Place(0, {auv}, {{0.0, 0.0, 0.0}}, {towards + Vec3<double>{0.0, 0.001, 0.001}});
    for (int k = 0; k < 100; ++k) world.Step(NoForce(1));
    const Vec3<double> p = Lane(world.target(0).p_WT, 0), v = Lane(world.target(0).v_WT, 0);
    const Vec3<double> away = p - Lane(world.vehicle(0).p_WB, 0);
    EXPECT_LT(AngleBetween(v, away), 0.01);
    for (int k = 0; k < 100; ++k) world.Step(NoForce(1));
    EXPECT_GT(Norm(Lane(world.target(0).p_WT, 0) - Lane(world.vehicle(0).p_WB, 0)), Norm(away));
  }
}

TEST(TargetMotion, EvasiveTargetEscapesEvenWhenHeadedStraightAtTheAuv) {
  World world(TargetScenario("evasive"));
  world.Place(0, {{0.08, 0.0, 0.0}}, {{0.0, 0.0, 0.0}}, {{0.01, 0.0, 0.0}});
  for (int k = 0; k < 300; ++k) world.Step(NoForce(1));
  const Vec3<double> away = Lane(world.target(0).p_WT, 0) - Vec3<double>{0.08, 0.0, 0.0};
  EXPECT_GT(Norm(away), 0.1);
  EXPECT_LT(AngleBetween(Lane(world.target(0).v_WT, 0), away), 0.5);
}

TEST(TargetMotion, EvasiveTargetOutOfRangeKeepsItsCourse) {
  World world(TargetScenario("evasive"));
  world.Place(0, {{0.0, 0.5, 0.0}}, {{0.0, 0.0, 0.0}}, {{0.01, 0.002, 0.0}});
  for (int k = 0; k < 100; ++k) world.Step(NoForce(1));
  EXPECT_EQ(Norm(Lane(world.target(0).v_WT, 0) - Vec3<double>{0.01, 0.002, 0.0}), 0.0);
}

/// Waypoint n of target 0 in episode 0.
Vec3<double> Waypoint(std::uint64_t seed, std::uint32_t n) {
  Random random(seed, Stream::kTarget, 0, n, 0);
  const double x = random.Uniform(-0.8, 0.8), y = random.Uniform(-0.8, 0.8);
  return {x, y, random.Uniform(-0.8, 0.8)};
}

struct Tour {
  int visited = 0, skipped = 0, longest_wait = 0;
};

/// Follows a target through its waypoints in order. The target may skip a few of them.
Tour FollowTour(const WorldScenario& scenario, std::uint64_t seed, int steps) {
  World world(scenario);
  world.Reset(0, seed, 0, ResetStage::kHard);
  Tour tour;
  std::uint32_t next = 0;
  int wait = 0;
  for (int k = 0; k < steps; ++k) {
    const Vec3<double> p = Lane(world.target(0).p_WT, 0);
    tour.longest_wait = std::max(tour.longest_wait, ++wait);
    for (std::uint32_t ahead = 0; ahead < 3; ++ahead) {
      if (Norm(p - Waypoint(seed, next + ahead)) >= 0.05) continue;
      tour.skipped += static_cast<int>(ahead);
      ++tour.visited;
      next += ahead + 1;
      wait = 0;
      break;
    }
    world.Step(NoForce(1));
  }
  return tour;
}

TEST(TargetMotion, WaypointTargetVisitsItsWaypointsInOrderAndNeverOrbitsOne) {
  WorldScenario scenario = TargetScenario("random_waypoint");
  for (const double speed : {0.02, 0.05}) {
    scenario.world.reset.stages[2].target_speed_mps = {speed, speed};
    // Time for two ways along the diagonal of the waypoint cube and a turn, in steps.
    const int patience = static_cast<int>(2.0 * 1.6 * std::sqrt(3.0) / speed / 0.1) + 300;
    Tour sum;
    // At 0.05 m/s the turning circle is wider than the arrival radius. In some of these seeds a
    // target would circle a waypoint for ever.
    for (std::uint64_t seed = 20; seed < 60; ++seed) {
      const Tour tour = FollowTour(scenario, seed, 16000);
      EXPECT_LT(tour.longest_wait, patience) << "seed " << seed << " speed " << speed;
      EXPECT_GE(tour.visited, speed == 0.02 ? 15 : 40);
      sum.visited += tour.visited;
      sum.skipped += tour.skipped;
    }
    EXPECT_LT(sum.skipped, sum.visited / 20);
  }
}

TEST(TargetMotion, SeveralTargetsMoveIndependently) {
  WorldScenario scenario = TargetScenario("coordinated_turn");
  scenario.run.agents = 2;
  scenario.world.target.count = 2;
  World world(scenario);
  const Vec3<double> v{0.01, 0.0, 0.0};
  world.Place(0, {{0.0, 0.3, 0.0}, {0.0, -0.3, 0.0}}, {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, {v, v});
  for (int k = 0; k < 50; ++k) world.Step(NoForce(2));
  EXPECT_GT(Norm(Lane(world.target(0).v_WT, 0) - Lane(world.target(1).v_WT, 0)), 1e-5);
}

}  // namespace
}  // namespace stg::dynamics

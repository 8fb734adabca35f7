#include <gtest/gtest.h>

#include <algorithm>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "auv_dynamics/world/world.hpp"

namespace stg::dynamics {
namespace {

WorldScenario Water(int agents) {
  WorldScenario s;
  s.run.agents = agents;
  s.world.sea.open = true;
  s.world.vehicle.model = "kinematic";
  s.world.vehicle.max_velocity_mps = {2.0, 2.0, 0.5};
  s.world.vehicle.kinematic.speed_lag_s = 0.1;
  s.world.vehicle.radius_m = 1.0;
  s.world.workspace.half_extent_m = 500.0;
  s.world.target.max_speed_mps = 0.9;
  s.world.target.max_turn_rate_radps = 0.05;
  s.world.reset.start_half_extent_m = 450.0;
  s.world.reset.min_separation_m = 20.0;
  for (ResetStageConfig& stage : s.world.reset.stages) {
    stage = {{0.0, 200.0}, {50.0, 200.0}, {0.3, 0.9}};
  }
  s.world.sensing.range_m = 400.0;
  return s;
}

const Obstacle kSphere{Obstacle::Kind::kSphere, {10.0, -20.0, -40.0}, 15.0, 0.0};
const Obstacle kCylinder{Obstacle::Kind::kCylinder, {10.0, -20.0, -60.0}, 15.0, 40.0};

TEST(Obstacle, InsideIsANegativeDistanceAndExpelGoesToTheNearestPlaceOnTheSurface) {
  for (const Obstacle& o : {kSphere, kCylinder}) {
    int inside = 0;
    for (std::uint32_t k = 0; k < 2000; ++k) {
      Random random(1, Stream::kReset, 0, 0, k);
      Vec3<double> p{random.Uniform(-10.0, 30.0), random.Uniform(-40.0, 0.0),
                     random.Uniform(-65.0, -15.0)};
      const double depth = -o.Distance(p);
      const bool in = Lane(o.Inside({Pack(p.x), Pack(p.y), Pack(p.z)}), 0) != 0.0;
      ASSERT_EQ(in, depth > 0.0) << p.x << " " << p.y << " " << p.z;
      if (!in) continue;
      ++inside;
      const Vec3<double> from = p, out = o.Expel(&p);
      EXPECT_NEAR(Norm(p - from), depth, 1e-9);
      EXPECT_NEAR(o.Distance(p), 0.0, 1e-9);
      EXPECT_NEAR(o.Distance(p + out * 2.0), 2.0, 1e-9);
    }
    EXPECT_GT(inside, 100);
  }
}

TEST(Obstacles, HoldAVehicleAtTheirSurfaceAndCountItOnceUntilItIsOff) {
  WorldScenario s = Water(1);
  s.world.sea.cylinders = {{50.0, 0.0, -120.0, 20.0, 120.0}};
  World world(s);
  world.Place(0, {{0.0, 3.0, -40.0}}, {{400.0, 400.0, -40.0}}, {{}});
  bool touched = false;
  for (int k = 0; k < 600; ++k) {
    world.Step({Pack(2.0), Pack(0.0), Pack(0.0)});
    const Vec3<double> p = Lane(world.vehicle(0).p_WB, 0);
    ASSERT_GE(world.sea().scape().Clearance(p), -1e-9);
    touched = touched || Lane(world.sea().touching(0), 0) == 1.0;
  }
  EXPECT_TRUE(touched);
  EXPECT_EQ(Lane(world.sea().collisions(0), 0), 1.0);
  // The vehicle slid along the obstacle and has left it behind.
  EXPECT_GT(Lane(world.vehicle(0).p_WB.x, 0), 70.0);
  EXPECT_EQ(Lane(world.sea().touching(0), 0), 0.0);
  world.Reset(0, 1, 0, ResetStage::kMedium);
  EXPECT_EQ(Lane(world.sea().collisions(0), 0), 0.0);
}

TEST(Obstacles, LeaveRoomToTurnAtTheStart) {
  WorldScenario s = Water(4);
  s.world.sea.spheres = {{0.0, 0.0, -40.0, 60.0}};
  s.world.sea.cylinders = {{150.0, 0.0, -120.0, 40.0, 120.0}};
  World world(s);
  double nearest = 1e9;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    world.Reset(0, seed, 0, ResetStage::kMedium);
    for (int i = 0; i < 4; ++i) {
      nearest = std::min(nearest, world.sea().scape().Clearance(Lane(world.vehicle(i).p_WB, 0)));
    }
  }
  EXPECT_GT(nearest, 30.0);
  EXPECT_LT(nearest, 35.0);
}

TEST(Obstacles, BlockTheSensorAndNothingElseDoes) {
  WorldScenario s = Water(1);
  s.world.sea.spheres = {{100.0, 0.0, -40.0, 10.0}};
  World world(s);
  Detection detection;
  world.Place(0, {{0.0, 0.0, -40.0}}, {{200.0, 0.0, -40.0}}, {{}});
  EXPECT_FALSE(world.Sense(0, 0, 0, &detection));
  world.Place(0, {{0.0, 0.0, -40.0}}, {{200.0, 30.0, -40.0}}, {{}});
  EXPECT_TRUE(world.Sense(0, 0, 0, &detection));
  const auto sees = ShadowsOf(s.world.sea, 500.0);
  EXPECT_FALSE(sees({0.0, 0.0, -40.0}, {200.0, 0.0, -40.0}));
  EXPECT_TRUE(sees({0.0, 0.0, -40.0}, {200.0, 30.0, -40.0}));
  EXPECT_FALSE(ShadowsOf(Water(1).world.sea, 500.0))
      << "open water over a flat bottom has no shadows";
}

TEST(Obstacles, EpisodesStartClearOfThemOrAreRefused) {
  WorldScenario s = Water(3);
  s.world.sea.spheres = {{0.0, 0.0, -40.0, 120.0}};
  World world(s);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    world.Reset(0, seed, 0, ResetStage::kMedium);
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(world.sea().scape().Clearance(Lane(world.vehicle(i).p_WB, 0)), 5.0);
    }
    EXPECT_GT(world.sea().scape().Clearance(Lane(world.target(0).p_WT, 0)), 5.0);
  }
  const auto why = [&world](const Vec3<double>& p) {
    try {
      world.Place(0, {{400.0, 0.0, -40.0}, p, {-400.0, 0.0, -40.0}}, {{300.0, 300.0, -40.0}}, {{}});
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(why({50.0, 0.0, -40.0}).find("AUV 1 would start inside an obstacle"),
            std::string::npos);
  EXPECT_NE(why({400.0, 400.0, -130.0}).find("AUV 1 would start inside the bottom"),
            std::string::npos);
  EXPECT_NE(why({400.0, 400.0, 1.0}).find("above the surface"), std::string::npos);
  EXPECT_EQ(why({400.0, 400.0, -40.0}), "");
  s.world.sea.spheres = {{0.0, 0.0, -40.0, 1000.0}};
  World full(s);
  EXPECT_THROW(full.Reset(0, 1, 0, ResetStage::kMedium), UserError);
}

TEST(Obstacles, TargetsOfEveryMotionGoRoundThemAtTheirSpeed) {
  for (const char* motion : {"coordinated_turn", "legs", "random_waypoint", "evasive"}) {
    WorldScenario s = Water(1);
    s.world.target.motion = motion;
    s.world.sea.cylinders = {{60.0, 0.0, -120.0, 30.0, 120.0}, {-80.0, 40.0, -120.0, 30.0, 120.0}};
    World world(s);
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      world.Reset(0, seed, 0, ResetStage::kMedium);
      const double speed = Norm(Lane(world.target(0).v_WT, 0));
      for (int k = 0; k < 6000; ++k) {
        world.Step({Pack(1.0), Pack(0.02), Pack(0.0)});
        ASSERT_GE(world.sea().scape().Clearance(Lane(world.target(0).p_WT, 0)), -1e-9) << motion;
        ASSERT_NEAR(Norm(Lane(world.target(0).v_WT, 0)), speed, 1e-6) << motion;
      }
    }
  }
}

TEST(Obstacles, AreRowsOfNumbersInAFile) {
  WorldScenario s = Water(1);
  s.world.sea.spheres = {{1.0, 2.0, -3.5, 4.0}, {5.0, 6.0, -7.0, 8.25}};
  s.world.sea.cylinders = {{1.0, 2.0, -30.0, 4.0, 10.0}};
  const std::string text = config::ToYaml(s);
  EXPECT_NE(text.find("spheres: [[1.0, 2.0, -3.5, 4.0], [5.0, 6.0, -7.0, 8.25]]"),
            std::string::npos)
      << text;
  const WorldScenario read = config::LoadText<WorldScenario>(text, "here");
  EXPECT_EQ(read.world.sea.spheres, s.world.sea.spheres);
  EXPECT_EQ(read.world.sea.cylinders, s.world.sea.cylinders);
  s.world.sea.spheres = {{1.0, 2.0, -3.5, 0.0}};
  EXPECT_THROW(config::ValidateOrThrow(s), UserError);
  s.world.sea.spheres = {{1.0, 2.0, -3.5}};
  EXPECT_THROW(config::ValidateOrThrow(s), UserError);
}

}  // namespace
}  // namespace stg::dynamics

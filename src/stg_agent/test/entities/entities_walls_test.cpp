#include <gtest/gtest.h>

#include <algorithm>

#include "entities/entity_examples.hpp"

/// Entities of AUVs between walls, at any scale.
namespace stg::agent {
namespace {

/// The example of the field between walls at +-`wall_m`. All its lengths are multiplied by
/// `length`, and all its times by `time`.
EntityExample BetweenWalls(unsigned seed, double wall_m, double radius_m, double length,
                           double time, double turn = 0.0) {
  EntityExample x = MakeExample(seed, 5, turn);
  const double speed = length / time;
  AgentModel& m = x.model;
  m.sea.open = false;
  m.workspace.half_extent_m = wall_m * length;
  m.vehicle.radius_m = radius_m * length;
  m.task.desired_distance_m *= length;
  m.run.time.dt_s = 0.25 * time;  // a decision is 5 s, as long as a command in the field
  m.channel.access = "periodic";
  m.observation.error_scale_m *= length;
  m.observation.near_range_m *= length;
  m.observation.progress_scale_m *= length;
  for (auto& b : m.sea.spheres) {
    for (double& v : b) v *= length;
  }
  for (auto& b : m.sea.cylinders) {
    for (double& v : b) v *= length;
  }
  Knowledge<double>& k = x.knowledge;
  k.p_WB = k.p_WB * length;
  k.v_WB_B = k.v_WB_B * speed;
  k.v_WB = k.v_WB * speed;
  k.w_WB_B = k.w_WB_B * (1.0 / time);
  k.r_BT_W = k.r_BT_W * length;
  k.v_WT = k.v_WT * speed;
  k.distance *= length;
  k.previous_distance *= length;
  k.error *= length;
  k.mean_error *= length;
  const auto later = [time](TimeNs t) {
    return static_cast<TimeNs>(std::llround(static_cast<double>(t) * time));
  };
  x.memory.now = later(x.memory.now);
  x.memory.position_std_m *= length;
  x.memory.own_detection[0] = later(x.memory.own_detection[0]);
  Covariance3& P = x.belief.P_WT;
  for (double* v : {&P.xx, &P.xy, &P.xz, &P.yy, &P.yz, &P.zz}) *v *= length * length;
  for (NeighbourState& r : x.reports) {
    r.position_std_m *= length;
    for (dynamics::Detection& d : r.sightings) d.stamp = later(d.stamp);
  }
  for (EntityNeighbour& n : x.neighbours) {
    n.sight.age_s *= time;
    n.sight.v_W = n.sight.v_W * speed;
    n.sight.r_BN_W = n.sight.r_BN_W * length;
    n.sight.distance_m *= length;
    n.sight.tracking_error *= length;
  }
  return x;
}

Entities Build(const EntityExample& x, double length, double time) {
  EntityInput in = x.input();
  in.velocity_std_mps *= length / time;
  in.information_age_s *= time;
  Entities e;
  BuildEntities(in, &e);
  return e;
}

void ExpectEqual(const Entities& a, const Entities& b, const std::string& where) {
  ASSERT_EQ(a.targets, b.targets) << where;
  ASSERT_EQ(a.neighbours, b.neighbours) << where;
  ASSERT_EQ(a.obstacles, b.obstacles) << where;
  const auto rows = [&where](const float* x, const float* y, int count, const char* what) {
    for (int k = 0; k < count; ++k) EXPECT_NEAR(x[k], y[k], 1e-5) << where << what << k;
  };
  rows(a.self, b.self, kSelfNumbers, ": self ");
  rows(a.target[0], b.target[0], a.targets * kTargetNumbers, ": target ");
  rows(a.neighbour[0], b.neighbour[0], a.neighbours * kNeighbourNumbers, ": neighbour ");
  rows(a.obstacle[0], b.obstacle[0], a.obstacles * kObstacleNumbers, ": obstacle ");
  rows(a.edge[0][0], b.edge[0][0], a.neighbours * kEdgeNumbers, ": edge ");
}

TEST(EntitiesBetweenWalls, AreTheSameForAScenarioOfAnyScale) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    for (const double radius : {2.0, 30.0}) {
      const Entities field = Build(BetweenWalls(seed, 260.0, radius, 1.0, 1.0), 1.0, 1.0);
      EXPECT_GT(field.obstacles, 3) << "there are walls";
      for (const auto& [length, time] : {std::pair{1.0 / 6000.0, 0.02}, std::pair{0.2, 1.0}}) {
        ExpectEqual(field, Build(BetweenWalls(seed, 260.0, radius, length, time), length, time),
                    "seed " + std::to_string(seed));
      }
    }
  }
}

TEST(EntitiesBetweenWalls, TurnWithTheWalls) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Entities north = Build(BetweenWalls(seed, 260.0, 2.0, 1.0, 1.0), 1.0, 1.0);
    for (const int quarters : {1, 2, 3}) {
      const double turn = quarters * kPi / 2.0;
      ExpectEqual(north, Build(BetweenWalls(seed, 260.0, 2.0, 1.0, 1.0, turn), 1.0, 1.0),
                  std::to_string(quarters) + " quarters of a turn");
    }
  }
}

TEST(EntitiesBetweenWalls, UnitsFollowFromTheTaskAndInOpenWaterTheyAreOne) {
  AgentModel m = FieldModel();
  m.task.desired_distance_m = 60.0;
  m.vehicle.radius_m = 40.0;
  const EntityScales open(m);
  EXPECT_EQ(open.length, 1.0);
  EXPECT_EQ(open.time, 1.0);
  EXPECT_EQ(open.speed, 1.0);
  EXPECT_EQ(open.apart_m, 20.0);
  EXPECT_EQ(open.Far(123.0), FarScale(123.0));
  m.sea.open = false;
  m.task.desired_distance_m = 0.015;
  m.vehicle.radius_m = 0.011;
  m.run.time.dt_s = 0.1;
  m.run.time.decision_steps = 1;
  const EntityScales walls(m);
  EXPECT_DOUBLE_EQ(walls.length, 1.0 / 6000.0);
  EXPECT_DOUBLE_EQ(walls.time, 0.02);
  EXPECT_DOUBLE_EQ(walls.speed, 1.0 / 120.0);
  EXPECT_DOUBLE_EQ(walls.apart_m, 0.022);
  EXPECT_NEAR(walls.Band(0.010, 0.015), -1.0, 1e-6);
  EXPECT_NEAR(walls.Speed(2.3 / 120.0), 1.0, 1e-12);
  EXPECT_NEAR(walls.Age(0.1), AgeScale(5.0), 1e-7);
}

/// An AUV at (200, 0, 0) m, its target at `target`, walls at +-1000 m, d* = 90 m, units of 1.
Entities NearWalls(const Vec3<double>& target) {
  EntityExample x = BetweenWalls(1, 1000.0, 2.0, 1.0, 1.0);
  x.model.sea.spheres.clear();
  x.model.sea.cylinders.clear();
  x.knowledge.p_WB = {200.0, 0.0, 0.0};
  x.knowledge.v_WB_B = {};
  Orient(kPi / 2.0, &x.knowledge);  // towards +y
  x.knowledge.r_BT_W = target - x.knowledge.p_WB;
  return Build(x, 1.0, 1.0);
}

TEST(EntitiesBetweenWalls, ShowTheWallsNearTheAuvOrItsTarget) {
  EXPECT_EQ(NearWalls({200.0, 90.0, 0.0}).obstacles, 0) << "no wall within 500 m";
  const Entities e = NearWalls({910.0, 0.0, -820.0});
  ASSERT_EQ(e.obstacles, 2);
  const auto row = [&e](int o) {
    return std::vector<float>(e.obstacle[o], e.obstacle[o] + kObstacleNumbers);
  };
  // The wall at x = 1000 m is to starboard, 800 m from the AUV and 90 m from the target.
  const std::vector<float> side = row(0);
  EXPECT_EQ(side[2], 1.0F);
  EXPECT_NEAR(side[3], 0.0, 1e-6);
  EXPECT_NEAR(side[4], -1.0, 1e-6);
  EXPECT_NEAR(side[5], FarScale(800.0), 1e-6);
  EXPECT_EQ(side[6], kEntityClip);
  EXPECT_NEAR(side[8], 0.0, 1e-6) << "the target is d* from it";
  EXPECT_NEAR(side[9], 0.0, 1e-6);
  // The wall below is 180 m from the target.
  const std::vector<float> below = row(1);
  EXPECT_NEAR(below[3], 0.0, 1e-6);
  EXPECT_NEAR(below[4], 0.0, 1e-6);
  EXPECT_NEAR(below[5], FarScale(1000.0), 1e-6);
  EXPECT_NEAR(below[8], 1.0, 1e-6);
  EXPECT_NEAR(below[9], -1.0, 1e-6);
}

}  // namespace
}  // namespace stg::agent

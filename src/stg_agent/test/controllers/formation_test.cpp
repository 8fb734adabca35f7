#include "stg_agent/controllers/formation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "auv_common/numbers/lane_structs.hpp"

namespace stg::agent {
namespace {

/// Four torpedoes in open water, d* 90 m, all at the depth of the target.
AgentModel Sea() {
  AgentModel s;
  s.run.agents = 4;
  s.sea.open = true;
  s.sea.auv_depth_m = {40.0, 40.0};
  s.vehicle.max_velocity_mps = {2.5, 2.5, 0.5};
  s.target.max_speed_mps = 2.0;
  s.task.desired_distance_m = 90.0;
  s.control.max_delta = s.control.smoothing = 0.0;
  s.run.time.dt_s = 1e-9;  // duration of a decision
  return s;
}

using Places = std::array<Level<double>, 4>;

/// Velocity that the law gives AUV `id` [m/s], world axes. The target is at the origin.
Level<double> Velocity(const AgentModel& s, const FormationOptions& o, const Places& p,
                       const Level<double>& v_T, int id) {
  Knowledge<double> k;
  const auto u = static_cast<std::size_t>(id);
  k.p_WB = {p[u].x, p[u].y, -40.0};
  k.r_BT_W = {-p[u].x, -p[u].y, 0.0};
  k.v_WB = k.v_WT = {v_T.x, v_T.y, 0.0};
  k.trig = {0.0, 1.0, 0.0, 1.0, 0.0, 1.0};
  k.R_WB = RotationOf(k.trig);
  std::vector<NeighbourSight<double>> others;
  for (int j = 0; j < 4; ++j) {
    if (j == id) continue;
    const auto w = static_cast<std::size_t>(j);
    NeighbourSight<double> n;
    n.known = 1.0;
    n.p_W = n.p_WN = {p[w].x, p[w].y, -40.0};
    n.v_W = k.v_WT;
    others.push_back(n);
  }
  double a[3];
  ControllerOf<Formation>(Formation{o}).Act({s, id, k, others.data(), 3}, a);
  return {a[0] * s.vehicle.max_velocity_mps[0], a[1] * s.vehicle.max_velocity_mps[1]};
}

Places Ring(std::array<double, 4> degrees, double radius_m) {
  Places p;
  for (std::size_t i = 0; i < 4; ++i) {
    const double a = degrees[i] * kPi / 180.0;
    p[i] = {radius_m * std::cos(a), radius_m * std::sin(a)};
  }
  return p;
}

TEST(Formation, WhoStandsEvenlyFliesAsTheTargetDoes) {
  const AgentModel s = Sea();
  const Level<double> v_T{1.2, 0.9};
  const Places p = Ring({100.0, 10.0, -80.0, 190.0}, 90.0);
  for (int i = 0; i < 4; ++i) {
    const Level<double> v = Velocity(s, FormationOptions{}, p, v_T, i);
    EXPECT_NEAR(v.x, v_T.x, 1e-6) << i;
    EXPECT_NEAR(v.y, v_T.y, 1e-6) << i;
  }
}

TEST(Contain, StandsBesideTheCourse) {
  const AgentModel s = Sea();
  const double course = 30.0;
  const Level<double> v_T{1.5 * std::cos(course * kPi / 180.0),
                          1.5 * std::sin(course * kPi / 180.0)};
  const double ring_m = ContainOptions().radius * s.task.desired_distance_m;
  const Places even = Ring({course + 45.0, course - 45.0, course + 135.0, course - 135.0}, ring_m);
  for (int i = 0; i < 4; ++i) {
    const Level<double> v = Velocity(s, ContainOptions(), even, v_T, i);
    EXPECT_NEAR(v.x, v_T.x, 1e-6) << i;
    EXPECT_NEAR(v.y, v_T.y, 1e-6) << i;
  }
  // The AUVs are turned by 20 deg from their places, so all of them go back.
  const Places off = Ring({course + 65.0, course - 25.0, course + 155.0, course - 115.0}, ring_m);
  for (int i = 0; i < 4; ++i) {
    const Level<double> v = Velocity(s, ContainOptions(), off, v_T, i);
    EXPECT_LT(Cross(off[static_cast<std::size_t>(i)], v - v_T), -1.0) << i;
  }
}

TEST(Formation, AHeapBecomesARingWithoutAnybodyPassingAnother) {
  // The vehicles are points that move as commanded.
  const AgentModel s = Sea();
  FormationOptions o;
  o.lead_s = o.clearance_m = o.doubt_mps = 0.0;
  o.clearance_m = 1e-3;
  const Level<double> v_T{1.5, 0.0};
  Places p = Ring({170.0, 174.0, 184.0, 192.0}, 150.0);
  for (int step = 0; step < 1500; ++step) {
    Places next = p;
    for (int i = 0; i < 4; ++i) {
      const auto u = static_cast<std::size_t>(i);
      next[u] = p[u] + Velocity(s, o, p, v_T, i) - v_T;
    }
    p = next;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(Norm(p[i]), 90.0, 1.0);
    const Level<double>& ahead = p[(i + 1) % 4];
    EXPECT_NEAR(std::atan2(Cross(p[i], ahead), Dot(p[i], ahead)), 0.5 * kPi, 0.05);
  }
}

TEST(Formation, HasPlacesAroundATargetThatRests) {
  FormationOptions o;
  o.weave_below_mps = 0.0;
  for (const Slots slots : {Slots::kFree, Slots::kCourse}) {
    o.slots = slots;
    const Level<double> v =
        Velocity(Sea(), o, Ring({0.0, 90.0, 180.0, 270.0}, 90.0), {0.0, 0.0}, 0);
    EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y));
  }
}

TEST(Formation, KeepsOffTheChartAsEncircleDoes) {
  AgentModel s = Sea();
  s.control.autopilot.max_turn_rate_radps = 0.1;
  FormationOptions o;
  o.weave_below_mps = 0.0;
  // A cylinder is straight ahead on the way to the AUV's place. The AUV is 1 m from the zone that
  // it must not enter.
  const Places p = Ring({180.0, 0.0, 90.0, 270.0}, 400.0);
  const Level<double> free = Velocity(s, o, p, {0.5, 0.0}, 0);
  EXPECT_GT(free.x, 2.0);
  s.sea.cylinders = {{-400.0 + 51.0, 0.0, -60.0, 30.0, 60.0}};
  const Level<double> off = Velocity(s, o, p, {0.5, 0.0}, 0);
  EXPECT_LT(off.x, 0.6) << "it does not fly in any more";
  EXPECT_NEAR(Norm(off), Norm(free), 1e-9) << "it turns, and does not stop";
  s.sea.cylinders[0][2] = -200.0;  // its top is far below
  EXPECT_EQ(Velocity(s, o, p, {0.5, 0.0}, 0).x, free.x);
}

TEST(Formation, ASlowTargetIsCircled) {
  const AgentModel s = Sea();
  const Places p = Ring({0.0, 90.0, 180.0, 270.0}, 90.0);
  const Level<double> v = Velocity(s, FormationOptions{}, p, {0.0, 0.1}, 0);
  EXPECT_GT(v.y, 0.8);
}

TEST(Formation, DoesInLanesWhatItDoesAlone) {
  const AgentModel s = Sea();
  const ControllerOf<Formation> law(Formation{FormationOptions{}});
  Knowledge<Pack> k;
  std::vector<NeighbourSight<Pack>> others(2);
  std::array<Knowledge<double>, kLanes> one;
  for (int lane = 0; lane < kLanes; ++lane) {
    Knowledge<double>& o = one[static_cast<std::size_t>(lane)];
    o.p_WB = {30.0 * lane, -20.0, -40.0};
    o.r_BT_W = {-80.0 + 25.0 * lane, 60.0, 1.0};
    o.v_WB = {1.5, 0.2, 0.0};
    o.v_WT = {0.5 * lane, 0.9, 0.0};
    o.trig = {0.0, 1.0, 0.0, 1.0, 0.0, 1.0};
    o.R_WB = RotationOf(o.trig);
    SetLaneOf(&k, lane, o);
  }
  for (NeighbourSight<Pack>& n : others) {
    n.known = Pack(1.0);
    n.p_WN = n.p_W = {Pack(50.0), Pack(&n == &others[0] ? 90.0 : -70.0), Pack(-40.0)};
  }
  Pack a[3];
  law.Act({s, 0, k, others.data(), 2}, a);
  for (int lane = 0; lane < kLanes; ++lane) {
    std::vector<NeighbourSight<double>> seen{LaneOf(others[0], lane), LaneOf(others[1], lane)};
    double alone[3];
    law.Act({s, 0, one[static_cast<std::size_t>(lane)], seen.data(), 2}, alone);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(Lane(a[i], lane), alone[i], 1e-12) << lane;
  }
}

}  // namespace
}  // namespace stg::agent

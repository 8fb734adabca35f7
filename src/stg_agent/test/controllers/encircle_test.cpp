#include "stg_agent/controllers/encircle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "auv_common/numbers/lane_structs.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::agent {
namespace {

/// Four torpedoes in open water, d* 90 m.
AgentModel Sea() {
  AgentModel s;
  s.run.agents = 4;
  s.sea.open = true;
  s.vehicle.max_velocity_mps = {2.5, 2.5, 0.5};
  s.target.max_speed_mps = 1.0;
  s.task.desired_distance_m = 90.0;
  s.control.max_delta = s.control.smoothing = 0.0;
  s.run.time.dt_s = 1e-9;  // duration of a decision
  return s;
}

/// What AUV 1 of four knows. It is at its depth, at `p` from the target and with velocity v. The
/// target is at the same depth.
Knowledge<double> Near(const Vec3<double>& p, const Vec3<double>& v, const Vec3<double>& v_T = {}) {
  Knowledge<double> k;
  k.p_WB = {p.x, p.y, -20.0 - 40.0 / 3.0};
  k.r_BT_W = {-p.x, -p.y, 0.0};
  k.v_WB = v;
  k.v_WT = v_T;
  k.trig = {0.0, 1.0, 0.0, 1.0, 0.0, 1.0};
  k.R_WB = RotationOf(k.trig);
  return k;
}

/// Velocity that the law gives AUV `id` [m/s], world axes.
Vec3<double> Velocity(const AgentModel& s, const Knowledge<double>& k, EncircleOptions o = {},
                      const std::vector<NeighbourSight<double>>& neighbours = {}, int id = 1) {
  double a[3];
  ControllerOf<Encircle>(Encircle{o})
      .Act({s, id, k, neighbours.data(), static_cast<int>(neighbours.size())}, a);
  const auto& limit = s.vehicle.max_velocity_mps;
  return {a[0] * limit[0], a[1] * limit[1], a[2] * limit[2]};
}

NeighbourSight<double> Sight(const Vec3<double>& p, const Vec3<double>& v, double age_s = 0.0) {
  NeighbourSight<double> n;
  n.known = 1.0;
  n.p_W = p;
  n.v_W = v;
  n.age_s = age_s;
  n.p_WN = p + v * age_s;
  return n;
}

TEST(Encircle, CirclesAnticlockwiseAtTheCruiseSpeedAndPointsAtATargetFarOff) {
  EncircleOptions o;
  o.lead_s = 0.0;
  const Vec3<double> on = Velocity(Sea(), Near({90.0, 0.0, 0.0}, {0.0, 1.0, 0.0}), o);
  EXPECT_NEAR(on.x, 0.0, 1e-9);
  EXPECT_NEAR(on.y, o.cruise_mps, 1e-9);
  EXPECT_NEAR(on.z, 0.0, 1e-9);
  const Vec3<double> far = Velocity(Sea(), Near({5000.0, 0.0, 0.0}, {-2.0, 0.0, 0.0}), o);
  EXPECT_NEAR(far.x, -o.fast_mps, 0.001);
  EXPECT_NEAR(far.y, 0.0, 0.03);
  EXPECT_LT(Velocity(Sea(), Near({110.0, 0.0, 0.0}, {0.0, 1.0, 0.0}), o).x, -0.3);
  EXPECT_GT(Velocity(Sea(), Near({70.0, 0.0, 0.0}, {0.0, 1.0, 0.0}), o).x, 0.3);
}

TEST(Encircle, TwoCirclesMoveTowardsEachOtherOnly) {
  AgentModel s = Sea();
  const Encircle law{EncircleOptions{}};
  const Knowledge<double> k = Near({90.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
  const auto radius = [&](int id, double circle, double wider) {
    return law.Guided(ControllerInput<double>{s, id, k, nullptr, 0}, circle, wider);
  };
  EXPECT_EQ(radius(1, 90.0, 10.0), 100.0);
  EXPECT_EQ(radius(1, 90.0, -10.0), 80.0);
  EXPECT_EQ(radius(1, 90.0, -80.0), 0.25 * 90.0);
  s.run.agents = 12;
  const double inner = law.Radius(ControllerInput<double>{s, 0, k, nullptr, 0}, 0.0);
  const double outer = law.Radius(ControllerInput<double>{s, 1, k, nullptr, 0}, 0.0);
  EXPECT_NEAR(inner, 72.0, 1e-9);
  EXPECT_NEAR(outer, 108.0, 1e-9);
  EXPECT_EQ(radius(0, 72.0, -10.0), 72.0);
  EXPECT_EQ(radius(0, 72.0, 10.0), 82.0);
  EXPECT_EQ(radius(1, 108.0, 10.0), 108.0);
  EXPECT_EQ(radius(1, 108.0, -10.0), 98.0);
  EXPECT_EQ(radius(1, 108.0, 200.0), 248.0) << "a lost target is still searched on wide circles";
}

TEST(Encircle, LargeTeamsSwerveLess) {
  AgentModel s = Sea();
  const EncircleOptions o;
  const auto swerve = [&](int agents) {
    s.run.agents = agents;
    // Both fly along the x axis. The other passes at 40 m, so the swerve is small against the
    // speed.
    const Knowledge<double> k = Near({5000.0, 0.0, 0.0}, {-2.0, 0.0, 0.0});
    const NeighbourSight<double> other = Sight({4900.0, 40.0, k.p_WB.z}, {1.0, 0.0, 0.0});
    return Velocity(s, k, o, {other}).y - Velocity(s, k, o).y;
  };
  const double ten = swerve(10), eleven = swerve(11);
  EXPECT_LT(ten, -0.1) << "away from the other";
  EXPECT_NEAR(eleven / ten, o.ring_dodge / o.dodge, 0.02);
}

TEST(Encircle, GroundSpeedStaysBetweenItsLimitsWhateverTheTargetDoes) {
  const AgentModel s = Sea();
  const EncircleOptions o;
  for (std::uint32_t k = 0; k < 3000; ++k) {
    Random random(1, Stream::kReset, 0, 0, k);
    const auto draw = [&random](double most) { return random.Uniform(-most, most); };
    std::vector<NeighbourSight<double>> others;
    for (int j = 0; j < 3; ++j) {
      others.push_back(Sight({draw(200.0), draw(200.0), -40.0}, {draw(2.0), draw(2.0), 0.0},
                             random.Uniform(0.0, 60.0)));
    }
    const Vec3<double> v = Velocity(s,
                                    Near({draw(400.0), draw(400.0), 0.0},
                                         {draw(2.0), draw(2.0), 0.0}, {draw(0.9), draw(0.9), 0.0}),
                                    o, others);
    const double speed = std::hypot(v.x, v.y);
    ASSERT_GE(speed, o.slow_mps - 1e-9);
    ASSERT_LE(speed, o.fast_mps + 1e-9);
  }
}

TEST(Encircle, FliesFasterOverGroundWhereACurrentMayCarryIt) {
  AgentModel s = Sea();
  EncircleOptions o;
  o.lead_s = 0.0;
  const auto speed = [&] { return Velocity(s, Near({90.0, 0.0, 0.0}, {0.0, 1.0, 0.0}), o).y; };
  EXPECT_NEAR(speed(), o.cruise_mps, 1e-9);
  s.max_current_mps = 0.8;
  EXPECT_NEAR(speed(), o.cruise_mps, 1e-9) << "not unless slow-in-current says so";
  o.slow_in_current = 0.5;
  EXPECT_NEAR(speed(), o.slow_mps + 0.4, 1e-9);
  s.max_current_mps = 0.1;
  EXPECT_NEAR(speed(), o.cruise_mps, 1e-9) << "the smallest speed is smaller than cruise";
}

TEST(Encircle, MakesForTheMiddleBetweenThoseAheadAndBehind) {
  EncircleOptions o;
  o.lead_s = 0.0;
  o.cruise_mps = 1.0;
  o.spread_gain = 0.5;
  o.clearance_m = o.mate_clearance_m = 1.0;
  const Knowledge<double> k = Near({90.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
  const auto at = [](double degrees) {
    const double a = degrees * kPi / 180.0;
    return Sight({90.0 * std::cos(a), 90.0 * std::sin(a), -60.0}, {-std::sin(a), std::cos(a), 0.0});
  };
  EXPECT_NEAR(Velocity(Sea(), k, o, {at(120.0), at(-120.0)}).y, 1.0, 1e-9);
  EXPECT_NEAR(Velocity(Sea(), k, o, {at(150.0), at(-110.0)}).y, 1.0 + 0.5 * 20.0 * kPi / 180.0,
              1e-9);
  // An old packet of a neighbour: since then, the neighbour has come closer on the circle.
  const double lap_s = 2.0 * kPi * 90.0;
  NeighbourSight<double> old = at(-40.0);
  old.age_s = 20.0 / 360.0 * lap_s;
  EXPECT_NEAR(Velocity(Sea(), k, o, {old}).y, Velocity(Sea(), k, o, {at(-20.0)}).y, 1e-9);
}

TEST(Encircle, PassesOthersAtLikeDepthAndObstaclesAside) {
  EncircleOptions o;
  const Knowledge<double> k = Near({1000.0, 0.0, 0.0}, {-2.0, 0.0, 0.0});
  const auto aside = [&](double y, double z) {
    return Velocity(Sea(), k, o, {Sight({960.0, y, z}, {1.5, 0.0, 0.0})}).y;
  };
  const double alone = Velocity(Sea(), k, o).y;
  EXPECT_LT(aside(10.0, -33.0), alone - 0.1);
  EXPECT_GT(aside(-10.0, -33.0), alone + 0.1);
  EXPECT_NEAR(aside(10.0, -60.0), alone, 1e-12);
  AgentModel s = Sea();
  s.sea.cylinders = {{940.0, 10.0, -120.0, 20.0, 120.0}};
  EXPECT_LT(Velocity(s, k, o).y, alone - 0.1);
  s.sea.cylinders = {{940.0, 10.0, -120.0, 20.0, 30.0}};
  EXPECT_NEAR(Velocity(s, k, o).y, alone, 1e-12) << "it ends 57 m below";
}

TEST(Encircle, KeepsOffByTheDeviationOfItsOwnPosition) {
  Knowledge<double> k = Near({1000.0, 0.0, 0.0}, {-2.0, 0.0, 0.0});
  AgentModel s = Sea();
  s.sea.cylinders = {{930.0, 10.0, -120.0, 20.0 + 12.0, 120.0}};
  const Vec3<double> large = Velocity(s, k);
  s.sea.cylinders = {{930.0, 10.0, -120.0, 20.0, 120.0}};
  EXPECT_GT(std::abs(Velocity(s, k).y - large.y), 0.1);
  k.position_std_m = 12.0;
  EXPECT_NEAR(Velocity(s, k).x, large.x, 1e-12);
  EXPECT_NEAR(Velocity(s, k).y, large.y, 1e-12);
}

TEST(Encircle, NeverComesIntoADiscFromWhichItCanTurnAway) {
  // A point wants to fly into the disc. It turns at 5 deg/s towards the velocity that the law
  // gives.
  const double rate = 0.0873, speed = 2.0, dt = 0.1, radius = 70.0;
  for (std::uint32_t n = 0; n < 300; ++n) {
    Random random(5, Stream::kReset, n, 0, 0);
    double x = -250.0, y = random.Uniform(-120.0, 120.0), heading = random.Uniform(-1.0, 1.0);
    double least = 1e9, aim = 0.0;
    for (int k = 0; k < 6000; ++k) {
      if (k % 400 == 0) aim = random.Uniform(-kPi, kPi);
      // To the centre all the time, or in a random direction for a while.
      const bool through = n % 2 == 0;
      const Level<double> there{-x, -y};
      const Level<double> wanted =
          through ? there * (speed / Norm(there))
                  : Level<double>{speed * std::cos(aim), speed * std::sin(aim)};
      const Level<double> own{speed * std::cos(heading), speed * std::sin(heading)};
      const Level<double> v = TurnedOff(wanted, own, there, radius, speed / rate);
      const double error = std::remainder(std::atan2(v.y, v.x) - heading, 2.0 * kPi);
      heading += std::clamp(error, -rate * dt, rate * dt);
      x += speed * std::cos(heading) * dt;
      y += speed * std::sin(heading) * dt;
      least = std::min(least, std::hypot(x, y));
    }
    ASSERT_GT(least, radius - 2.0) << "way " << n;
  }
}

TEST(Encircle, LeavesAVelocityThatLeadsPast) {
  const Level<double> past{0.0, 2.0}, away{-1.0, 0.5};
  for (const Level<double>& v : {past, away}) {
    const Level<double> same = TurnedOff(v, v, {100.0, 0.0}, 70.0, 23.0);
    EXPECT_EQ(same.x, v.x);
    EXPECT_EQ(same.y, v.y);
  }
  // At a distance of two turning radii even the way to the centre is free.
  const Level<double> in{2.0, 0.0};
  EXPECT_EQ(TurnedOff(in, in, {70.0 + 46.1, 0.0}, 70.0, 23.0).x, 2.0);
  EXPECT_LT(TurnedOff(in, in, {70.0, 0.0}, 70.0, 23.0).x, 1e-9);
}

TEST(Encircle, SpreadsOverTheDepthsOfTheScenario) {
  const Knowledge<double> k = Near({90.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
  EXPECT_GT(Velocity(Sea(), k, {}, {}, 0).z, 0.2);   // to 20 m
  EXPECT_LT(Velocity(Sea(), k, {}, {}, 3).z, -0.2);  // to 60 m
}

TEST(Encircle, IsTheSameInEveryLane) {
  const AgentModel s = Sea();
  const ControllerOf<Encircle> law(Encircle{});
  for (std::uint32_t n = 0; n < 2000; ++n) {
    Knowledge<Pack> packed;
    NeighbourSight<Pack> seen;
    double expected[kLanes][3];
    for (int lane = 0; lane < kLanes; ++lane) {
      Random random(2, Stream::kReset, n, static_cast<std::uint32_t>(lane), 0);
      const auto draw = [&random](double most) { return random.Uniform(-most, most); };
      const Knowledge<double> k = Near({draw(300.0), draw(300.0), 0.0}, {draw(2.0), draw(2.0), 0.0},
                                       {draw(0.9), draw(0.9), 0.0});
      const NeighbourSight<double> other =
          Sight({draw(200.0), draw(200.0), -40.0}, {draw(2.0), draw(2.0), 0.0}, 10.0);
      SetLaneOf(&packed, lane, k);
      SetLaneOf(&seen, lane, other);
      law.Act({s, 1, k, &other, 1}, expected[lane]);
    }
    Pack a[3];
    law.Act({s, 1, packed, &seen, 1}, a);
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int c = 0; c < 3; ++c) ASSERT_EQ(Lane(a[c], lane), expected[lane][c]);
    }
  }
}

}  // namespace
}  // namespace stg::agent

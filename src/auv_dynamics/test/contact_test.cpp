#include <gtest/gtest.h>

#include <cmath>

#include "physics.hpp"

namespace stg::dynamics {
namespace {

constexpr double kSurgeMass = 31.9 + 2.0, kSwayMass = 31.9 + 35.0;

WorldScenario ContactScenario(int agents) {
  WorldScenario s = QuietScenario(agents);
  s.world.vehicle = ReleaseVehicle();
  return s;
}

World PlacedWorld(const WorldScenario& scenario, const std::vector<Vec3<double>>& p_WB) {
  World world(scenario);
  for (int lane = 0; lane < kLanes; ++lane) {
    world.Place(lane, p_WB, {{0.5, 0.5, 0.5}}, {{0.0, 0.0, 0.0}});
  }
  return world;
}

/// World momentum that vehicle i gets in one step from rest, at zero attitude [N s].
Vec3<double> Momentum(const World& world, int i) {
  const Vec3<double> v = Lane(world.vehicle(i).v_WB, 0);
  return {v.x * kSurgeMass, v.y * kSwayMass, v.z * kSwayMass};
}

TEST(Contact, ForceEqualsTheClosedForm) {
  for (const double d : {0.004, 0.015, 0.0219, 0.022, 0.0225, 0.025, 0.05}) {
    World world = PlacedWorld(ContactScenario(2), {{0.0, 0.0, 0.0}, {d, 0.0, 0.0}});
    world.Step(NoForce(2));
    const double force = 100.0 * 0.001 * std::log1p(std::exp((0.022 - d) / 0.001));
    EXPECT_NEAR(Momentum(world, 1).x, 0.1 * force, 1e-15 + 1e-12 * force) << d;
    EXPECT_NEAR(Momentum(world, 0).x, -0.1 * force, 1e-15 + 1e-12 * force) << d;
  }
}

TEST(Contact, ForceAtTouchIsSoftnessTimesLogTwo) {
  World world = PlacedWorld(ContactScenario(2), {{0.0, 0.0, 0.0}, {0.0, 0.022, 0.0}});
  world.Step(NoForce(2));
  EXPECT_NEAR(Momentum(world, 1).y, 0.1 * 0.1 * 0.693147180559945, 1e-15);
}

TEST(Contact, MomentumIsEqualAndOpposite) {
  const std::vector<Vec3<double>> p{
      {0.0, 0.0, 0.0}, {0.01, 0.005, 0.0}, {-0.004, 0.012, 0.009}, {0.006, -0.003, 0.015}};
  World world = PlacedWorld(ContactScenario(4), p);
  world.Step(NoForce(4));
  Vec3<double> sum;
  for (int i = 0; i < 4; ++i) {
    sum += Momentum(world, i);
    EXPECT_GT(Norm(Momentum(world, i)), 1e-3);
  }
  EXPECT_NEAR(Norm(sum), 0.0, 1e-15);
}

TEST(Contact, VehiclesApartFeelNothing) {
  World world = PlacedWorld(ContactScenario(2), {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.063}});
  world.Step(NoForce(2));
  EXPECT_EQ(Norm(Momentum(world, 0)), 0.0);
}

TEST(Contact, ForceIsFeltInBodyAxesOfATurnedVehicle) {
  // The bow of vehicle 0 points along world y, so a push along x is a sway force.
  WorldScenario scenario = ContactScenario(2);
  World world = PlacedWorld(scenario, {{0.0, 0.0, 0.0}, {0.02, 0.0, 0.0}});
  VehicleState<Pack>& s = world.mutable_vehicle(0);
  s.rpy.z = Pack(kPi / 2);
  s.trig = TrigOf(s.rpy);
  s.R_WB = RotationOf(s.trig);
  world.Step(NoForce(2));
  const double force = 0.1 * std::log1p(std::exp(2.0));
  EXPECT_NEAR(Lane(world.vehicle(0).v_WB.x, 0), -0.1 * force / kSwayMass, 1e-15);
  EXPECT_NEAR(Lane(world.vehicle(0).v_WB_B.y, 0), 0.1 * force / kSwayMass, 1e-15);
}

TEST(Contact, JoinsTheCommandBeforeTheActuatorLimit) {
  World world = PlacedWorld(ContactScenario(2), {{0.0, 0.0, 0.0}, {0.01, 0.0, 0.0}});
  std::vector<Wrench<Pack>> tau = NoForce(2);
  tau[0].force.x = Pack(-35.0);  // full thrust away from the contact: contact adds nothing
  tau[1].force.x = Pack(-35.0);  // full thrust into the contact: contact takes from it
  world.Step(tau);
  const double force = 0.1 * std::log1p(std::exp(12.0));
  EXPECT_NEAR(Momentum(world, 0).x, -3.5, 1e-13);
  EXPECT_NEAR(Momentum(world, 1).x, 0.1 * (-35.0 + force), 1e-13);
}

TEST(Contact, PairsCloserThanTwoRadiiAreCounted) {
  const std::vector<Vec3<double>> p{
      {0.0, 0.0, 0.0}, {0.0219, 0.0, 0.0}, {0.0, 0.0221, 0.0}, {0.0, 0.0, -0.010}};
  const World world = PlacedWorld(ContactScenario(4), p);
  EXPECT_EQ(Lane(world.colliding_pairs(), 0), 2.0);  // the pairs 0-1 and 0-3
  EXPECT_NEAR(Lane(world.smallest_separation(), 0), 0.010, 1e-15);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const Vec3<double> r = p[static_cast<size_t>(i)] - p[static_cast<size_t>(j)];
      EXPECT_NEAR(Lane(world.distance(i, j), 0), Norm(r), 1e-15);
    }
  }
}

TEST(Contact, CoincidentVehiclesStayFinite) {
  World world = PlacedWorld(ContactScenario(2), {{0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}});
  for (int k = 0; k < 10; ++k) world.Step(NoForce(2));
  EXPECT_TRUE(std::isfinite(Lane(world.vehicle(0).p_WB.x, 0)));
  EXPECT_EQ(Lane(world.colliding_pairs(), 0), 1.0);
}

TEST(Contact, PushesOverlappingVehiclesApart) {
  World world = PlacedWorld(ContactScenario(2), {{0.0, 0.0, 0.0}, {0.0, 0.012, 0.003}});
  for (int k = 0; k < 300; ++k) world.Step(NoForce(2));
  EXPECT_GT(Lane(world.smallest_separation(), 0), 0.022);
  EXPECT_EQ(Lane(world.colliding_pairs(), 0), 0.0);
}

TEST(Contact, APairInContactDoesNotMoveTheFarPairOfAnotherLane) {
  World alone(ContactScenario(2)), mixed(ContactScenario(2));
  for (int lane = 0; lane < kLanes; ++lane) {
    const double gap = lane == 1 ? 0.02 : 0.07;
    alone.Place(lane, {{0.0, 0.0, 0.0}, {0.07, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{}});
    mixed.Place(lane, {{0.0, 0.0, 0.0}, {gap, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{}});
  }
  for (int k = 0; k < 10; ++k) {
    alone.Step(NoForce(2));
    mixed.Step(NoForce(2));
  }
  EXPECT_EQ(Lane(mixed.vehicle(0).v_WB.x, 0), Lane(alone.vehicle(0).v_WB.x, 0));
  EXPECT_LT(Lane(mixed.vehicle(0).v_WB.x, 1), -1e-4);
}

}  // namespace
}  // namespace stg::dynamics

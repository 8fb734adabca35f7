#include "auv_dynamics/world/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>

#include "auv_common/error.hpp"
#include "physics.hpp"

namespace {
std::size_t allocations = 0;
}

// Counts every allocation of this test program. Not inlined: the compiler would otherwise see
// malloc paired with delete and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t align) {
  ++allocations;
  const auto a = static_cast<std::size_t>(align);
  if (void* p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace stg::dynamics {
namespace {

TEST(World, RefusesAScenarioThatFailsItsValidation) {
  WorldScenario scenario = QuietScenario(2);
  scenario.run.time.dt_s = -0.1;
  EXPECT_THROW(World{scenario}, UserError);
}

TEST(World, TimeIsStepsTimesDt) {
  WorldScenario scenario = QuietScenario(1);
  World world(scenario);
  world.Reset(0, 1, 0, ResetStage::kMedium);
  for (int k = 0; k < 123; ++k) world.Step(NoForce(1));
  EXPECT_EQ(world.time(0), 12300000000);
  EXPECT_EQ(world.Nav(0, 0).stamp, world.time(0));
}

TEST(World, NamesTheVehicleWhoseStateIsNotFinite) {
  WorldScenario scenario = QuietScenario(3);
  World world(scenario);
  for (int lane = 0; lane < kLanes; ++lane) world.Reset(lane, 40, 0, ResetStage::kMedium);
  world.Step(NoForce(3));
  EXPECT_NO_THROW(world.CheckFinite());
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    World broken(scenario);
    for (int lane = 0; lane < kLanes; ++lane) {
      broken.Reset(lane, 40 + static_cast<std::uint64_t>(lane), 0, ResetStage::kMedium);
    }
    broken.Step(NoForce(3));
    SetLane(&broken.mutable_vehicle(1).w_WB_B.z, kLanes - 1, bad);
    try {
      broken.CheckFinite();
      FAIL() << bad;
    } catch (const UserError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("AUV 1 is not finite after 1 physics steps"), std::string::npos) << text;
      EXPECT_NE(text.find("seed " + std::to_string(40 + kLanes - 1)), std::string::npos) << text;
    }
  }
}

/// Vehicle 0 of the release, at p with body velocity v and zero attitude.
World AtWall(const Vec3<double>& p, const Vec3<double>& v) {
  WorldScenario scenario = QuietScenario(1);
  scenario.world.vehicle = ReleaseVehicle();
  scenario.world.vehicle.linear_damping = {};
  scenario.world.vehicle.quadratic_damping = {};
  World world(scenario);
  for (int lane = 0; lane < kLanes; ++lane) {
    world.Place(lane, {p}, {{0.0, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
  }
  world.mutable_vehicle(0).v_WB_B = Broadcast(v);
  return world;
}

TEST(World, WallClampsAndReflectsByHandValues) {
  World world = AtWall({0.99, 0.0, 0.0}, {0.4, 0.2, -0.1});
  world.Step(NoForce(1));
  const VehicleState<Pack>& s = world.vehicle(0);
  EXPECT_EQ(Lane(s.p_WB.x, 0), 1.0);
  EXPECT_NEAR(Lane(s.p_WB.y, 0), 0.02, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB.x, 0), -0.2 * 0.4, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB.y, 0), 0.85 * 0.2, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB.z, 0), 0.85 * -0.1, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB_B.x, 0), 0.7 * 0.4, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB_B.y, 0), 0.7 * 0.2, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB_B.z, 0), 0.7 * -0.1, 1e-15);
}

TEST(World, WallTakesAFifthOfTheBodyRates) {
  World world = AtWall({0.0, 0.0, -0.999}, {0.0, 0.0, -0.3});
  world.mutable_vehicle(0).w_WB_B.z = Pack(0.5);
  world.Step(NoForce(1));
  EXPECT_EQ(Lane(world.vehicle(0).p_WB.z, 0), -1.0);
  EXPECT_NEAR(Lane(world.vehicle(0).w_WB_B.z, 0), 0.8 * 0.5, 1e-15);
}

TEST(World, CornerReflectsTwoAxesAndSlowsBodyOnce) {
  World world = AtWall({0.99, -0.99, 0.0}, {0.4, -0.3, 0.1});
  world.Step(NoForce(1));
  const VehicleState<Pack>& s = world.vehicle(0);
  EXPECT_EQ(Lane(s.p_WB.x, 0), 1.0);
  EXPECT_EQ(Lane(s.p_WB.y, 0), -1.0);
  // Each wall reflects its own axis and slows the other two.
  EXPECT_NEAR(Lane(s.v_WB.x, 0), -0.2 * 0.4 * 0.85, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB.y, 0), 0.2 * 0.3 * 0.85, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB.z, 0), 0.1 * 0.85 * 0.85, 1e-15);
  EXPECT_NEAR(Lane(s.v_WB_B.x, 0), 0.7 * 0.4, 1e-15);
}

TEST(World, NothingHappensJustInsideTheWall) {
  World world = AtWall({0.95, 0.0, 0.0}, {0.4, 0.0, 0.0});
  world.Step(NoForce(1));
  EXPECT_NEAR(Lane(world.vehicle(0).p_WB.x, 0), 0.99, 1e-15);
  EXPECT_NEAR(Lane(world.vehicle(0).v_WB_B.x, 0), 0.4, 1e-15);
}

TEST(World, CommandIsClippedToTheActuatorLimits) {
  WorldScenario scenario = QuietScenario(1);
  scenario.world.vehicle = ReleaseVehicle();
  World world(scenario);
  world.Place(0, {{0.0, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
  std::vector<Wrench<Pack>> tau = NoForce(1);
  tau[0] = {{Pack(1e6), Pack(-1e6), Pack(1e6)}, {Pack(0.0), Pack(0.0), Pack(-1e6)}};
  world.Step(tau);
  EXPECT_NEAR(Lane(world.vehicle(0).v_WB_B.x, 0), 0.1 * 35.0 / 33.9, 1e-15);
  EXPECT_NEAR(Lane(world.vehicle(0).v_WB_B.y, 0), -0.1 * 20.0 / 66.9, 1e-15);
  EXPECT_NEAR(Lane(world.vehicle(0).v_WB_B.z, 0), 0.1 * 20.0 / 66.9, 1e-15);
  EXPECT_NEAR(Lane(world.vehicle(0).w_WB_B.z, 0), -0.1 * 10.0 / 8.6, 1e-15);
}

TEST(World, CommandIsRoundedToFloatOnlyWhereAskedFor) {
  for (const bool rounded : {false, true}) {
    WorldScenario scenario = QuietScenario(1);
    scenario.world.vehicle = ReleaseVehicle();
    scenario.world.vehicle.float32_tau = rounded;
    World world(scenario);
    world.Place(0, {{0.0, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
    std::vector<Wrench<Pack>> tau = NoForce(1);
    tau[0].force.x = Pack(0.1);
    world.Step(tau);
    const double force = rounded ? static_cast<double>(0.1F) : 0.1;
    EXPECT_NEAR(Lane(world.vehicle(0).v_WB_B.x, 0), 0.1 * force / 33.9, 1e-18);
  }
}

TEST(World, CurrentCarriesTheWholeSwarmAtItsSpeed) {
  WorldScenario scenario = QuietScenario(2);
  scenario.world.workspace.half_extent_m = 100.0;
  scenario.world.reset.start_half_extent_m = 0.9;
  scenario.world.current.velocity_mps = {0.1, -0.05, 0.02};
  World world(scenario);
  world.Reset(0, 1, 0, ResetStage::kMedium);
  for (int k = 0; k < 2000; ++k) world.Step(NoForce(2));
  for (int i = 0; i < 2; ++i) {
    const Vec3<double> v = Lane(world.vehicle(i).v_WB, 0);
    EXPECT_NEAR(Norm(v - Vec3<double>{0.1, -0.05, 0.02}), 0.0, 1e-8);
  }
}

TEST(World, DisturbanceHasItsStationaryDeviationAndCorrelationTime) {
  WorldScenario scenario = QuietScenario(1);
  scenario.world.vehicle = ReleaseVehicle();
  scenario.world.vehicle.linear_damping = {};
  scenario.world.vehicle.quadratic_damping = {};
  scenario.world.vehicle.clip_velocity = false;
  scenario.world.workspace.half_extent_m = 1e5;
  scenario.world.disturbance.force_std_n = 3.0;
  scenario.world.disturbance.correlation_time_s = 0.5;
  World world(scenario);
  for (int l = 0; l < kLanes; ++l)
    world.Reset(l, 11, static_cast<std::uint32_t>(l), ResetStage::kMedium);
  constexpr int kSteps = 40000;
  double squares = 0.0, products = 0.0;
  std::vector<double> previous_speed(static_cast<size_t>(kLanes)), previous(previous_speed);
  for (int k = 0; k < kSteps; ++k) {
    world.Step(NoForce(1));
    for (int l = 0; l < kLanes; ++l) {
      const auto i = static_cast<size_t>(l);
      // Without damping or turning, the change of surge speed shows the force.
      const double speed = Lane(world.vehicle(0).v_WB_B.x, l);
      const double z = (speed - previous_speed[i]) * 33.9 / 0.1 / 3.0;
      squares += z * z;
      products += z * previous[i];
      previous_speed[i] = speed;
      previous[i] = z;
    }
  }
  const double n = static_cast<double>(kSteps) * kLanes, decay = std::exp(-0.1 / 0.5);
  // Variance of the sample variance of an AR(1) process: (2/n)(1+a^2)/(1-a^2).
  const double deviation = std::sqrt(2.0 / n * (1.0 + decay * decay) / (1.0 - decay * decay));
  EXPECT_NEAR(squares / n, 1.0, 5.0 * deviation);
  EXPECT_NEAR(products / n, decay, 5.0 * deviation);
}

TEST(World, DisturbanceIsNotLimitedByTheActuators) {
  WorldScenario scenario = QuietScenario(1);
  scenario.world.vehicle = ReleaseVehicle();
  scenario.world.disturbance.force_std_n = 1e4;
  World world(scenario);
  world.Reset(0, 12, 0, ResetStage::kMedium);
  world.Step(NoForce(1));
  EXPECT_EQ(std::abs(Lane(world.vehicle(0).v_WB_B.x, 0)), 1.5);  // 35 N would give less in one step
}

TEST(World, StepAllocatesNothing) {
  for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicit}) {
    for (const std::string motion : {"coordinated_turn", "legs", "random_waypoint", "evasive"}) {
      WorldScenario scenario = QuietScenario(8);
      scenario.world.vehicle.integrator = integrator;
      scenario.world.vehicle.float32_tau = true;
      scenario.world.target.motion = motion;
      scenario.world.disturbance = {1.0, 0.1, 2.0};
      scenario.world.sensing = {"position", 0.45, 0.01, 0.9, 0.1, 1.0, 0.05};
      World world(scenario);
      for (int l = 0; l < kLanes; ++l) world.Reset(l, 3, 0, ResetStage::kEasy);
      std::vector<Wrench<Pack>> tau = NoForce(8);
      for (auto& t : tau) t.force = {Pack(30.0), Pack(5.0), Pack(-8.0)};  // into the walls
      Detection detection;
      const std::size_t before = allocations;
      for (int k = 0; k < 200; ++k) {
        world.Step(tau);
        for (int i = 0; i < 8; ++i) world.Sense(0, i, 0, &detection);
      }
      const std::size_t after = allocations;
      EXPECT_EQ(after, before);
      EXPECT_EQ(Lane(world.vehicle(0).p_WB.x, 0), 1.0);
    }
  }
  EXPECT_GT(allocations, 0U);  // the counter works
}

}  // namespace
}  // namespace stg::dynamics

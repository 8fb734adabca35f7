#include <gtest/gtest.h>

#include <cstring>

#include "auv_common/error.hpp"
#include "auv_dynamics/vehicle/torpedo.hpp"
#include "physics.hpp"

// Facts that hold for every registered kind of vehicle, and the closed forms of `kinematic`.
namespace stg::dynamics {
namespace {

/// A sea without walls in reach.
WorldScenario Sea(const std::string& model, int agents) {
  WorldScenario s = QuietScenario(agents);
  s.world.vehicle.model = model;
  s.world.vehicle.max_velocity_mps = {2.0, 2.0, 0.5};
  s.world.vehicle.max_rate_radps = {0.5, 0.5, 0.2};
  s.world.workspace.half_extent_m = 1e4;
  s.run.time.dt_s = 0.05;
  return s;
}

std::vector<Vec3<double>> Line(int agents) {
  std::vector<Vec3<double>> places;
  for (int i = 0; i < agents; ++i) places.push_back({0.0, 50.0 * i, -30.0});
  return places;
}

void Launch(World* world, int lane) {
  world->Place(lane, Line(world->agents()), {{100.0, 0.0, -30.0}}, {{0.0, 0.0, 0.0}});
}

/// A command, also beyond the limits, that changes every 20 steps.
double Command(int id, int k, int axis, const Axis& limits) {
  std::mt19937_64 random(static_cast<std::uint64_t>(1000 * (k / 20) + 10 * id + axis));
  return std::uniform_real_distribution<double>(1.2 * limits.lo, 1.2 * limits.hi)(random);
}

using Numbers = std::vector<double>;

/// Runs world ids[l] in lane l for 20 s. Returns the numbers of each lane.
std::vector<Numbers> Fly(const WorldScenario& scenario, const std::vector<int>& ids) {
  World world(scenario);
  const Space& axes = world.model().actuators();
  for (size_t l = 0; l < ids.size(); ++l) Launch(&world, static_cast<int>(l));
  std::vector<Pack> commands(static_cast<size_t>(world.agents()) * axes.size(), Pack(0.0));
  std::vector<Numbers> out(ids.size());
  for (int k = 0; k < 400; ++k) {
    for (size_t l = 0; l < ids.size(); ++l) {
      for (size_t c = 0; c < commands.size(); ++c) {
        SetLane(&commands[c], static_cast<int>(l),
                Command(ids[l], k, static_cast<int>(c), axes[c % axes.size()]));
      }
    }
    world.Step(commands);
    for (size_t l = 0; l < ids.size(); ++l) {
      for (int i = 0; i < world.agents(); ++i) {
        const NavState nav = world.Nav(static_cast<int>(l), i);
        for (const Vec3<double>& v : {nav.p_WB, nav.v_WB_B, nav.w_WB_B}) {
          out[l].insert(out[l].end(), {v.x, v.y, v.z});
        }
        out[l].insert(out[l].end(), nav.q_WB, nav.q_WB + 4);
      }
    }
  }
  return out;
}

TEST(VehicleKinds, EachLaneEqualsTheSameWorldAloneBitForBit) {
  for (const std::string model : {"fully_actuated", "torpedo", "kinematic"}) {
    for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicit}) {
      WorldScenario scenario = Sea(model, 2);
      scenario.world.vehicle.integrator = integrator;
      scenario.world.current.velocity_mps = {0.2, -0.3, 0.05};
      scenario.world.disturbance = {2.0, 0.2, 1.0};
      std::vector<int> ids;
      for (int l = 0; l < kLanes; ++l) ids.push_back(l);
      const std::vector<Numbers> together = Fly(scenario, ids);
      for (const int id : ids) {
        const Numbers alone = Fly(scenario, {id})[0];
        const Numbers& mine = together[static_cast<size_t>(id)];
        ASSERT_EQ(mine.size(), alone.size());
        EXPECT_EQ(std::memcmp(mine.data(), alone.data(), alone.size() * sizeof(double)), 0)
            << model << " lane " << id;
        for (const double x : alone) ASSERT_TRUE(std::isfinite(x)) << model;
      }
      if (kLanes > 1) {
        EXPECT_NE(together[0], together[1]);
      }
    }
  }
}

TEST(VehicleKinds, ScalarTorpedoEqualsTheWorldBitForBit) {
  const WorldScenario scenario = Sea("torpedo", 1);
  World world(scenario);
  Launch(&world, 0);
  const TorpedoModel model(scenario.world.vehicle.torpedo);
  VehicleState<double> s = AtAttitude({});
  s.p_WB = Line(1)[0];
  TorpedoActuators<double> actuators;
  const Space& axes = world.model().actuators();
  for (int k = 0; k < 400; ++k) {
    double c[3];
    std::vector<Pack> commands;
    for (size_t a = 0; a < 3; ++a) {
      c[a] = Command(0, k, static_cast<int>(a), axes[a]);
      commands.push_back(Pack(c[a]));
    }
    world.Step(commands);
    Integrate(model, scenario.world.vehicle,
              model.Limit(TorpedoActuators<double>{c[0], c[1], c[2]}), Wrench<double>(),
              Vec3<double>(), 0.05, &s, &actuators);
  }
  EXPECT_EQ(Norm(world.Nav(0, 0).p_WB - s.p_WB), 0.0);
  EXPECT_EQ(Norm(world.Nav(0, 0).w_WB_B - s.w_WB_B), 0.0);
}

TEST(VehicleKinds, MixedFleetsFlyAsEachKindAloneBitForBit) {
  WorldScenario mixed = Sea("torpedo", 3);
  mixed.world.vehicle.models = {"torpedo", "kinematic"};
  World fleet(mixed);
  ASSERT_EQ(&fleet.model(0), &fleet.model(2));
  ASSERT_NE(&fleet.model(0), &fleet.model(1));
  const std::size_t row = fleet.command_size();
  const auto command = [&](int i, int k, std::size_t a) {
    const Space& axes = fleet.model(i).actuators();
    return a < axes.size() ? Pack(Command(i, k, static_cast<int>(a), axes[a])) : Pack(0.0);
  };
  for (int i = 0; i < 3; ++i) {
    World alone(Sea(mixed.world.vehicle.model_of(i), 1));
    alone.Place(0, {Line(3)[static_cast<std::size_t>(i)]}, {{100.0, 0.0, -30.0}},
                {{0.0, 0.0, 0.0}});
    Launch(&fleet, 0);
    for (int k = 0; k < 400; ++k) {
      std::vector<Pack> all, own;
      for (int j = 0; j < 3; ++j) {
        for (std::size_t a = 0; a < row; ++a) all.push_back(command(j, k, a));
      }
      for (std::size_t a = 0; a < alone.command_size(); ++a) own.push_back(command(i, k, a));
      fleet.Step(all);
      alone.Step(own);
    }
    EXPECT_EQ(Norm(fleet.Nav(0, i).p_WB - alone.Nav(0, 0).p_WB), 0.0) << i;
    EXPECT_EQ(Norm(fleet.Nav(0, i).v_WB_B - alone.Nav(0, 0).v_WB_B), 0.0) << i;
    EXPECT_GT(Norm(fleet.Nav(0, i).p_WB - Line(3)[static_cast<std::size_t>(i)]), 1.0) << i;
  }
}

TEST(VehicleKinds, SteeredVehiclesDoNotFlyWithThoseThatForceCommands) {
  WorldScenario mixed = Sea("torpedo", 2);
  mixed.world.vehicle.models = {"torpedo", "fully_actuated"};
  EXPECT_THROW(World{mixed}, UserError);
}

TEST(VehicleKinds, TorpedoFeelsContactAndDisturbance) {
  WorldScenario scenario = Sea("torpedo", 2);
  scenario.world.vehicle.radius_m = 1.0;
  World world(scenario);
  world.Place(0, {{0.0, 0.0, -30.0}, {0.0, 1.5, -30.0}}, {{100.0, 0.0, -30.0}}, {{0.0, 0.0, 0.0}});
  const std::vector<Pack> still(6, Pack(0.0));
  world.Step(still);
  // The overlap of 0.5 m pushes with 50 N against the mass and added mass of sway. Roll takes a
  // part of the push.
  EXPECT_LT(Lane(world.vehicle(0).v_WB.y, 0), -0.02);
  EXPECT_GT(Lane(world.vehicle(1).v_WB.y, 0), 0.02);
}

TEST(VehicleKinds, ActuatorsStartAtZeroWithEachEpisode) {
  World world(Sea("torpedo", 1));
  for (int l = 0; l < kLanes; ++l) Launch(&world, l);
  for (int k = 0; k < 100; ++k) world.Step({Pack(1525.0), Pack(0.1), Pack(0.0)});
  Launch(&world, 0);
  world.Step(std::vector<Pack>(3, Pack(0.0)));
  EXPECT_EQ(Norm(world.Nav(0, 0).v_WB_B), 0.0);
  for (int l = 1; l < kLanes; ++l) EXPECT_GT(world.Nav(l, 0).v_WB_B.x, 2.0);
}

TEST(Kinematic, ReachesItsCommandsWithTheirLags) {
  WorldScenario scenario = Sea("kinematic", 1);
  World world(scenario);
  Launch(&world, 0);
  for (int k = 0; k < 40; ++k) world.Step({Pack(1.0), Pack(0.1), Pack(-0.2)});
  const NavState nav = world.Nav(0, 0);  // after 2 s
  EXPECT_NEAR(nav.v_WB_B.x, 1.0 - std::exp(-1.0), 1e-12);
  EXPECT_NEAR(nav.w_WB_B.z, 0.1 * (1.0 - std::exp(-2.0)), 1e-12);
  EXPECT_NEAR(nav.v_WB_B.z, -0.2 * (1.0 - std::exp(-1.0)), 1e-12);
}

TEST(Kinematic, FliesACircleOfSpeedOverRate) {
  World world(Sea("kinematic", 1));
  Launch(&world, 0);
  const std::vector<Pack> command{Pack(1.5), Pack(0.1), Pack(0.0)};
  for (int k = 0; k < 2000; ++k) world.Step(command);
  const NavState from = world.Nav(0, 0);
  // Half a turn takes pi / rate, and ends on the other side.
  const int half = static_cast<int>(std::lround(kPi / 0.1 / 0.05));
  for (int k = 0; k < half; ++k) world.Step(command);
  EXPECT_NEAR(Norm(world.Nav(0, 0).p_WB - from.p_WB), 2.0 * 15.0, 1e-3);
}

TEST(Kinematic, KeepsWithinItsLimitsAndDriftsWithTheCurrent) {
  WorldScenario scenario = Sea("kinematic", 1);
  scenario.world.vehicle.kinematic.min_speed_mps = 0.6;
  scenario.world.current.velocity_mps = {0.0, 0.3, -0.1};
  World world(scenario);
  Launch(&world, 0);
  for (int k = 0; k < 2000; ++k) world.Step({Pack(-5.0), Pack(0.0), Pack(9.0)});
  const NavState nav = world.Nav(0, 0);
  EXPECT_NEAR(nav.v_WB_B.x, 0.6, 1e-9);
  EXPECT_NEAR(nav.v_WB_B.y, 0.3, 1e-9);
  EXPECT_NEAR(nav.v_WB_B.z, 0.5 - 0.1, 1e-9);
  scenario.world.vehicle.kinematic.min_speed_mps = 3.0;
  EXPECT_THROW(World{scenario}, UserError);
}

TEST(VehicleKinds, StateTheirSpaces) {
  VehicleConfig config;
  const auto torpedo = Vehicles().Make("torpedo", config);
  ASSERT_EQ(torpedo->actuators().size(), 3u);
  EXPECT_EQ(torpedo->actuators()[0].unit, "rpm");
  EXPECT_EQ(torpedo->actuators()[0].hi, 1525.0);
  EXPECT_EQ(torpedo->actuators()[1].name, "rudder");
  EXPECT_NEAR(torpedo->actuators()[2].lo, -15.0 * kPi / 180.0, 1e-15);
  EXPECT_EQ(torpedo->internal_size(), 3);
  const auto kinematic = Vehicles().Make("kinematic", config);
  ASSERT_EQ(kinematic->actuators().size(), 3u);
  EXPECT_EQ(kinematic->actuators()[1].hi, config.max_rate_radps[2]);
  EXPECT_EQ(torpedo->actions().size(), 3u);
  EXPECT_EQ(kinematic->actions()[2].hi, config.max_velocity_mps[2]);
}

}  // namespace
}  // namespace stg::dynamics

#include <gtest/gtest.h>

#include <map>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_dynamics/targets/steered_motion.hpp"
#include "auv_dynamics/vehicle/fully_actuated.hpp"
#include "physics.hpp"

/// World flies vehicles, target motions and sensors of another program.
namespace stg::dynamics {
namespace {

/// Moves at the commanded velocity over ground. Contact and disturbance push it. Its internal state
/// counts the steps of the episode and adds up the commanded x.
class Cart : public Vehicle {
 public:
  const Space& actuators() const override { return actuators_; }
  const Space& actions() const override { return actuators_; }
  int internal_size() const override { return 2; }
  void Step(const Pack* command, const Surroundings& around, double dt, VehicleState<Pack>* s,
            Pack* internal) const override {
    internal[0] += Pack(1.0);
    internal[1] += command[0];
    const Vec3<Pack> v{command[0], command[1], command[2]};
    s->v_WB_B = s->R_WB.TransposeTimes(v + around.v_WC);
    FollowQuaternion(s);
    s->p_WB += s->v_WB * Pack(dt) + around.contact_W * Pack(0.01);
    s->rpy.x = internal[0];  // a test can read it there
    s->rpy.y = internal[1];
  }

 private:
  Space actuators_{{"v_x", "m/s", -9.0, 9.0}, {"v_y", "m/s", -9.0, 9.0}, {"v_z", "m/s", -9.0, 9.0}};
};

/// Moves straight up. A target with a higher index is faster. Counts the resets of each lane.
class Lift : public SteeredMotion {
 public:
  explicit Lift(const MotionSetup& setup) : SteeredMotion(setup) {}
  void Reset(int lane) override { ++resets[static_cast<size_t>(lane)]; }

  static std::array<int, kLanes> resets;

 private:
  Vec3<double> Steer(const Situation& now) override {
    return {0.0, 0.0, 0.01 * static_cast<double>(now.target + 1)};
  }
};
std::array<int, kLanes> Lift::resets{};

/// Senses in every second step. Tells the vector from the vehicle to the target.
class Blinker : public TargetSensor {
 public:
  MeasurementKind kind() const override { return MeasurementKind::kPosition; }
  bool Sense(const Look& look, Detection* out) const override {
    if (look.clock.step % 2 == 1) return false;
    out->stamp = look.stamp;
    out->target = look.target;
    out->std_m = look.time_s + look.pair;
    out->p_WT = look.p_WT() - look.p_WB();
    return true;
  }
};

/// Registers them once, however many tests run.
void AddOutsiders() {
  if (Vehicles().Has("cart")) return;
  Vehicles().Add("cart", [](const VehicleConfig&) { return std::make_unique<const Cart>(); });
  TargetMotions().Add("lift", [](const MotionSetup& s) { return std::make_unique<Lift>(s); });
  TargetSensors().Add("blinker",
                      [](const SensingConfig&) { return std::make_unique<const Blinker>(); });
}

WorldScenario OutsideScenario(int agents) {
  AddOutsiders();
  WorldScenario s = QuietScenario(agents);
  s.world.vehicle.model = "cart";
  s.world.target.motion = "lift";
  s.world.sensing.sensor = "blinker";
  s.world.workspace.half_extent_m = 10.0;
  s.world.current.velocity_mps = {0.0, 0.0, 0.5};
  return s;
}

TEST(Outside, VehicleMovesByItsOwnRuleUnderItsOwnCommand) {
  World world(OutsideScenario(2));
  ASSERT_EQ(world.model().actuators().size(), 3U);
  world.Place(0, {{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}}, {{0.0, 5.0, 0.0}}, {{0.0, 0.0, 0.0}});
  std::vector<Pack> commands{Pack(1.0), Pack(0.0),  Pack(0.0),   // vehicle 0
                             Pack(0.0), Pack(-2.0), Pack(0.0)};  // vehicle 1
  for (int k = 0; k < 10; ++k) world.Step(commands);
  const NavState a = world.Nav(0, 0), b = world.Nav(0, 1);
  EXPECT_NEAR(Norm(a.p_WB - Vec3<double>{1.0, 0.0, 0.5}), 0.0, 1e-12);
  EXPECT_NEAR(Norm(b.p_WB - Vec3<double>{3.0, -2.0, 0.5}), 0.0, 1e-12);
  EXPECT_EQ(a.q_WB[0], 1.0);
  EXPECT_EQ(Norm(a.v_WB_B - Vec3<double>{1.0, 0.0, 0.5}), 0.0);
}

TEST(Outside, VehicleFeelsContactAndWalls) {
  WorldScenario scenario = OutsideScenario(2);
  scenario.world.vehicle.radius_m = 1.0;
  World world(scenario);
  world.Place(0, {{0.0, 0.0, 0.0}, {1.5, 0.0, 9.99}}, {{0.0, 5.0, 0.0}}, {{0.0, 0.0, 0.0}});
  const std::vector<Pack> still(6, Pack(0.0));
  world.Step(still);
  EXPECT_EQ(Lane(world.vehicle(0).p_WB.x, 0), 0.0);  // 10 m apart
  // The current would add 0.05 m, but the wall stops it.
  EXPECT_EQ(Lane(world.vehicle(1).p_WB.z, 0), 10.0);
  world.Place(0, {{0.0, 0.0, 0.0}, {1.5, 0.0, 0.0}}, {{0.0, 5.0, 0.0}}, {{0.0, 0.0, 0.0}});
  world.Step(still);
  // The overlap of 0.5 m gives 50 N at 100 N/m. A cart moves 0.01 m per newton.
  EXPECT_NEAR(Lane(world.vehicle(0).p_WB.x, 0), -0.5, 1e-9);
  EXPECT_NEAR(Lane(world.vehicle(1).p_WB.x, 0), 2.0, 1e-9);
}

TEST(Outside, VehicleKeepsItsInternalStateUntilTheLaneStartsAgain) {
  World world(OutsideScenario(2));
  for (int l = 0; l < kLanes; ++l) world.Reset(l, 1, 0, ResetStage::kMedium);
  const std::vector<Pack> commands{Pack(1.0), Pack(0.0), Pack(0.0),
                                   Pack(0.5), Pack(0.0), Pack(0.0)};
  for (int k = 0; k < 4; ++k) world.Step(commands);
  world.Reset(0, 1, 1, ResetStage::kMedium);
  world.Step(commands);
  EXPECT_EQ(Lane(world.vehicle(0).rpy.x, 0), 1.0);
  EXPECT_EQ(Lane(world.vehicle(1).rpy.y, 0), 0.5);
  for (int l = 1; l < kLanes; ++l) {
    EXPECT_EQ(Lane(world.vehicle(0).rpy.x, l), 5.0);
    EXPECT_EQ(Lane(world.vehicle(1).rpy.y, l), 2.5);
  }
}

TEST(Outside, ForceAndMomentAreRefusedByAVehicleThatHasOtherActuators) {
  World world(OutsideScenario(2));
  EXPECT_THROW(world.Step(NoForce(2)), UserError);
}

TEST(Outside, TargetsMoveByTheirOwnRuleAndAreResetByLane) {
  WorldScenario scenario = OutsideScenario(2);
  scenario.world.target.count = 2;
  World world(scenario);
  const auto before = Lift::resets;
  world.Place(1 % kLanes, {{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}}, {{0.0, 5.0, 0.0}, {0.0, -5.0, 0.0}},
              {{0.0, 0.0, 0.01}, {0.0, 0.0, 0.01}});
  for (int l = 0; l < kLanes; ++l) {
    EXPECT_EQ(Lift::resets[static_cast<size_t>(l)] - before[static_cast<size_t>(l)],
              l == 1 % kLanes ? 1 : 0);
  }
  for (int k = 0; k < 10; ++k) world.Step(std::vector<Pack>(6, Pack(0.0)));
  EXPECT_NEAR(Lane(world.target(0).p_WT.z, 1 % kLanes), 0.01, 1e-15);
  EXPECT_NEAR(Lane(world.target(1).p_WT.z, 1 % kLanes), 0.02, 1e-15);
}

TEST(Outside, SensorSeesWhatItLooksAt) {
  WorldScenario scenario = OutsideScenario(2);
  scenario.world.target.count = 2;
  World world(scenario);
  world.Place(0, {{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}}, {{0.0, 5.0, 0.0}, {0.0, -5.0, 0.0}},
              {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  Detection detection;
  ASSERT_TRUE(world.Sense(0, 1, 1, &detection));
  EXPECT_EQ(Norm(detection.p_WT - Vec3<double>{-3.0, -5.0, 0.0}), 0.0);
  EXPECT_EQ(detection.target, 1);
  EXPECT_EQ(detection.std_m, 3.0);  // the index of the pair is 1 * 2 + 1, and the time is 0
  const std::vector<Pack> still(6, Pack(0.0));
  world.Step(still);
  EXPECT_FALSE(world.Sense(0, 1, 1, &detection));
  world.Step(still);
  ASSERT_TRUE(world.Sense(0, 0, 0, &detection));
  EXPECT_EQ(detection.stamp, 200000000);
  EXPECT_EQ(detection.std_m, 0.2);
}

TEST(Registries, KeysTakeNamesThatWereAddedAndListThem) {
  AddOutsiders();
  WorldScenario config;
  config::Table table;
  Describe(&config, &table);
  std::map<std::string, std::string> ranges;
  for (const config::Field& field : table.fields()) {
    if (const auto* names = std::get_if<config::EnumRef>(&field.value)) {
      ranges[field.path] = JoinNames(names->names);
    }
  }
  EXPECT_EQ(ranges["vehicle.model"], "fully_actuated | torpedo | kinematic | cart");
  EXPECT_EQ(ranges["target.motion"],
            "constant_velocity | coordinated_turn | legs | random_waypoint | evasive | lift");
  EXPECT_EQ(ranges["sensing.sensor"], "position | range | bearing | range_bearing | blinker");
  EXPECT_NO_THROW(config::ValidateOrThrow(OutsideScenario(2)));
}

TEST(Registries, WorldRefusesUnknownNamesWithTheKey) {
  const auto message = [](const WorldScenario& scenario) {
    try {
      World world(scenario);
    } catch (const UserError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  WorldScenario scenario = QuietScenario(1);
  scenario.world.vehicle.model = "submarine";
  EXPECT_NE(message(scenario).find("vehicle.model: must be one of fully_actuated"),
            std::string::npos);
  scenario = QuietScenario(1);
  scenario.world.target.motion = "random";
  EXPECT_NE(message(scenario).find("target.motion: "), std::string::npos);
  scenario = QuietScenario(1);
  scenario.world.sensing.sensor = "eyes";
  EXPECT_NE(message(scenario).find("sensing.sensor: "), std::string::npos);
}

TEST(Registries, FullyActuatedStatesItsSpaces) {
  VehicleConfig config;
  config.max_tau[3] = 7.0;
  config.max_velocity_mps[1] = 0.25;
  const auto vehicle = Vehicles().Make("fully_actuated", config);
  ASSERT_EQ(vehicle->actuators().size(), static_cast<size_t>(kWrenchSize));
  EXPECT_EQ(vehicle->actuators()[3].name, "K");
  EXPECT_EQ(vehicle->actuators()[3].unit, "N m");
  EXPECT_EQ(vehicle->actuators()[3].lo, -7.0);
  EXPECT_EQ(vehicle->actuators()[3].hi, 7.0);
  EXPECT_EQ(vehicle->internal_size(), 0);
  WorldScenario world;
  EXPECT_EQ(vehicle->actions().size(), static_cast<size_t>(world.world.control.action_size()));
  EXPECT_EQ(vehicle->actions()[1].hi, 0.25);
  world.world.control.interface = ActionInterface::kTau6;
  EXPECT_EQ(vehicle->actuators().size(), static_cast<size_t>(world.world.control.action_size()));
}

}  // namespace
}  // namespace stg::dynamics

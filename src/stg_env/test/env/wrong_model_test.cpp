// Agents whose model of the world differs from the world.

#include <gtest/gtest.h>

#include <algorithm>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_env/env/decide.hpp"

namespace stg::env {
namespace {

Scenario TestScenario(const std::string& name, const std::vector<std::string>& overrides) {
  return LoadNamedScenario(STG_SCENARIO_FOLDER, STG_SCENARIO_FOLDER "/../test/" + name + ".yaml",
                           "nominal", overrides);
}

/// Where the AUVs are after some decisions, and what they see and state on the way.
std::vector<double> Flight(const Scenario& s, const std::string& law, int decisions) {
  TestEnv env(s);
  env.Reset();
  const agent::Decider decider = agent::MakeDecider(law, s.model());
  std::vector<double> actions(
      static_cast<std::size_t>(env.envs() * env.agents() * env.action_size()));
  std::vector<double> seen;
  for (int k = 0; k < decisions; ++k) {
    Decide(decider, env, env.memory.observations.data(), actions.data());
    env.VectorEnv::Step(actions.data(), env.memory.arrays());
    for (const float x : env.memory.observations) seen.push_back(static_cast<double>(x));
    for (int e = 0; e < env.envs(); ++e) {
      const dynamics::NavState nav = env.navigation(e, 0);
      seen.insert(seen.end(), {nav.p_WB.x, nav.v_WB_B.x, nav.position_std_m, nav.heading_std_rad});
    }
  }
  return seen;
}

struct Case {
  const char* key;
  const char* value;
};

void ExpectEachMatters(const std::vector<Case>& cases, const Scenario& s, const std::string& law,
                       int decisions) {
  const std::vector<double> as_it_is = Flight(s, law, decisions);
  EXPECT_EQ(as_it_is, Flight(s, law, decisions));
  for (const Case& c : cases) {
    Scenario wrong = s;
    config::Override(&wrong, {"believed." + std::string(c.key) + "=" + c.value});
    EXPECT_NE(as_it_is, Flight(wrong, law, decisions)) << c.key;
  }
}

const std::vector<std::string> kDrifting{"track.measurements.observers=rates",
                                         "time.episode_steps=40", "sea.auv_depth_m=[0.0,0.1]",
                                         "sensing.detection_probability=0.9"};
/// The keys of the model that torpedoes read when they drift, range their target and search it.
const std::vector<Case> kTorpedoCases{
    {"vehicle.max_velocity_mps", "[2.0,2.3,0.5]"},
    {"vehicle.torpedo.length_m", "1.9"},
    {"vehicle.torpedo.diameter_m", "0.22"},
    {"vehicle.torpedo.cg_below_m", "0.03"},
    {"vehicle.torpedo.drag_coefficient", "0.6"},
    {"vehicle.torpedo.yaw_time_s", "1.3"},
    {"vehicle.torpedo.pitch_damping", "1.0"},
    {"vehicle.torpedo.fin_area_m2", "0.02"},
    {"vehicle.torpedo.rudder_lift", "0.7"},
    {"vehicle.torpedo.stern_plane_lift", "0.9"},
    {"vehicle.torpedo.max_fin_rad", "0.1"},
    {"vehicle.torpedo.propeller_diameter_m", "0.16"},
    {"vehicle.torpedo.max_propeller_rpm", "900.0"},
    {"vehicle.torpedo.thrust_coefficient", "[0.5,0.2]"},
    {"vehicle.torpedo.propeller_advance", "0.7"},
    {"vehicle.torpedo.propeller_inflow", "0.9"},
    {"vehicle.torpedo.thrust_deduction", "0.2"},
    {"workspace.half_extent_m", "1100.0"},
    {"sea.target_depth_m", "[30.0,50.0]"},
    {"target.max_speed_mps", "1.2"},
    {"navigation.dead_reckoning.dvl_scale_std", "0.004"},
    {"navigation.dead_reckoning.dvl_noise_mps", "0.03"},
    {"navigation.dead_reckoning.heading_std_deg", "1.0"},
    {"navigation.dead_reckoning.gyro_walk_deg_per_sqrt_h", "0.5"},
    {"navigation.dead_reckoning.depth_std_m", "1.0"},
    {"navigation.dead_reckoning.gps_std_m", "9.0"},
    {"navigation.dead_reckoning.start_std_m", "9.0"},
    {"navigation.dead_reckoning.current_std_mps", "0.3"},
    {"sensing.range_m", "250.0"},
    {"channel.extended.attenuation_per_m", "0.001"},
    {"channel.extended.loss_probability", "0.3"},
    {"channel.extended.loss_distance_m", "900.0"},
};

TEST(WrongModel, EachKeyChangesWhatAgentsDoOrSee) {
  ExpectEachMatters(kTorpedoCases, TestScenario("drifting", kDrifting), "pursuit_separated", 30);
  ExpectEachMatters({{"sensing.detection_probability", "0.4"}},
                    Short(Shipped("search", "nominal", {"sensing.period_s=5"}), 400), "search_map",
                    400);
}

TEST(WrongModel, EachKeyOfForceAndMomentAndOfTheChartMatters) {
  ExpectEachMatters({{"vehicle.max_tau", "[30.0,20.0,20.0,8.0,10.0,10.0]"},
                     {"vehicle.max_rate_radps", "[1.0,1.0,1.0]"},
                     {"vehicle.max_velocity_mps", "[1.2,0.5,0.5]"}},
                    Short(Shipped("medium", "nominal", {"control.heading=along_velocity"}), 10),
                    "pursuit", 10);
  ExpectEachMatters({{"channel.range_m", "0.3"}},
                    Short(Shipped("medium", "nominal", {"channel.model=range"}), 10), "pursuit",
                    10);
  ExpectEachMatters({{"sea.auv_depth_m", "[30.0,35.0]"},
                     {"sea.spheres", "[[0.0,0.0,-40.0,1500.0]]"},
                     {"sea.cylinders", "[[0.0,0.0,-120.0,1500.0,110.0]]"}},
                    Short(Shipped("field"), 12), "encircle", 12);
  ExpectEachMatters({{"channel.physical.modem.clock_offset_std_s", "0.01"},
                     {"channel.physical.modem.clock_drift_std_ppm", "100.0"}},
                    Short(Shipped("deep", "craft_crystal"), 60), "encircle", 60);
  ExpectEachMatters({{"sea.bottom_m", "70.0"}}, Short(Shipped("field"), 12),
                    STG_SCENARIO_FOLDER "/../policies/field.onnx", 12);
}

/// The cases above are all keys of the model.
TEST(WrongModel, EveryKeyIsTried) {
  std::vector<std::string> untried = agent::KeysOfModel();
  const auto tried = [&](const std::string& key) {
    untried.erase(std::remove(untried.begin(), untried.end(), key), untried.end());
  };
  for (const Case& c : kTorpedoCases) tried(c.key);
  for (const char* key :
       {"sensing.detection_probability", "vehicle.max_tau", "vehicle.max_rate_radps",
        "channel.range_m", "sea.auv_depth_m", "sea.spheres", "sea.cylinders", "sea.bottom_m",
        "channel.physical.modem.clock_offset_std_s",
        "channel.physical.modem.clock_drift_std_ppm"}) {
    tried(key);
  }
  EXPECT_EQ(untried, std::vector<std::string>());
}

/// The command is force and moment, so what agents believe changes no true state.
TEST(WrongModel, LeavesTheTruthAlone) {
  const Scenario s = Short(Shipped("medium", "nominal", {"control.interface=tau6"}), 30);
  Scenario wrong = s;
  config::Override(&wrong, {"believed.sensing.range_m=0.2", "believed.target.max_speed_mps=0.002",
                            "believed.vehicle.max_velocity_mps=[1.0,0.4,0.4]"});
  EXPECT_EQ(wrong.world.vehicle.max_velocity_mps, s.world.vehicle.max_velocity_mps);
  EXPECT_EQ(wrong.model().vehicle.max_velocity_mps[0], 1.0);
  TestEnv one(s), other(wrong);
  one.Reset();
  other.Reset();
  const VectorEnvOptions options;
  for (int k = 0; k < 30; ++k) {
    const std::vector<float> actions = ActionsOf(one, options);
    one.Step(actions);
    other.Step(actions);
    EXPECT_EQ(one.memory.states, other.memory.states);
    EXPECT_NE(one.memory.observations, other.memory.observations);
  }
}

/// The errors of the instruments do not change. The stated deviation follows what the vehicle
/// believes.
TEST(WrongModel, NavigationErrsAsBeforeAndStatesAnotherDeviation) {
  const Scenario s = TestScenario("drifting", kDrifting);
  Scenario wrong = s;
  config::Override(&wrong, {"believed.navigation.dead_reckoning.start_std_m=1.0"});
  TestEnv one(s), other(wrong);
  one.Reset();
  other.Reset();
  for (int i = 0; i < one.agents(); ++i) {
    const auto a = one.navigation(0, i), b = other.navigation(0, i);
    EXPECT_EQ(Norm(a.p_WB - b.p_WB), 0.0);
    EXPECT_EQ(a.position_std_m, 3.0);
    EXPECT_EQ(b.position_std_m, 1.0);
  }
}

TEST(WrongModel, KeysAreReadAsThoseThatTheyDifferFrom) {
  const auto load = [](const std::string& key) {
    return LoadNamedScenario(STG_SCENARIO_FOLDER, "medium", "nominal", {"believed." + key});
  };
  const std::pair<const char*, const char*> cases[] = {
      {"sensing.range_m=-1", "out of range"},
      {"sensing.range_m=far", "expected a number"},
      {"vehicle.fully_actuated.mass_kg=30", "agents have no value of their own for vehicle."},
      {"vehicle.torpedo.length_m=2", "belongs to the vehicle 'torpedo'"},
      {"sensing.rnge_m=1", "did you mean believed.sensing.range_m?"},
  };
  for (const auto& [key, why] : cases) {
    try {
      load(key);
      ADD_FAILURE() << key;
    } catch (const UserError& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  }
  const Scenario wrong = load("sensing.range_m=0.2");
  EXPECT_NE(ScenarioHash(wrong), ScenarioHash(Shipped("medium")));
  const Scenario again = config::LoadText<Scenario>(ToYaml(wrong), "text");
  EXPECT_EQ(again.model().sensing.range_m, 0.2);
  EXPECT_EQ(again.world.sensing.range_m, Shipped("medium").world.sensing.range_m);
}

}  // namespace
}  // namespace stg::env

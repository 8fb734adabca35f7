#include <gtest/gtest.h>

#include <algorithm>

#include "auv_common/config/loader.hpp"
#include "scenario/scenario_input.hpp"
#include "stg_env/scenario/scenario.hpp"

/// Keys of the world that have an effect only beside another choice.
namespace stg::scenario_test {
namespace {

using Keys = std::vector<std::string>;

Scenario Load(const std::string& name, const Keys& overrides) {
  return LoadNamedScenario(STG_SCENARIO_FOLDER, name, "nominal", overrides);
}

/// Both lists of overrides; `b` replaces overrides of the same keys in `a`.
Keys Joined(Keys a, const Keys& b) {
  for (const std::string& text : b) {
    const std::string key = text.substr(0, text.find('=') + 1);
    a.erase(std::remove_if(a.begin(), a.end(),
                           [&](const std::string& other) { return other.rfind(key, 0) == 0; }),
            a.end());
    a.push_back(text);
  }
  return a;
}

/// The same key is refused beside `choice`, and is read beside `cure`.
struct Case {
  std::string scenario;
  Keys choice;
  std::string key;  ///< override
  std::string why;  ///< part of the message
  Keys cure;
};

const std::vector<Case> kCases{
    {"field",
     {},
     "workspace.restitution=0.9",
     "world 'walls'; this configuration chose 'open water' (sea.open",
     {"sea.open=false"}},
    {"field", {}, "workspace.tangential=0.9", "world 'walls'", {"sea.open=false"}},
    {"field", {}, "workspace.body_velocity=0.9", "world 'walls'", {"sea.open=false"}},
    {"field", {}, "workspace.body_rate=0.9", "world 'walls'", {"sea.open=false"}},
    {"field",
     {},
     "vehicle.max_tau=[1,1,1,1,1,1]",
     "vehicle 'fully_actuated'; this configuration chose 'torpedo' (vehicle.model, vehicle.models",
     {"vehicle.model=fully_actuated"}},
    {"field",
     {},
     "believed.vehicle.max_tau=[1,1,1,1,1,1]",
     "vehicle 'fully_actuated'",
     {"vehicle.model=fully_actuated"}},
    {"field",
     {},
     "control.velocity_gain=9",
     "vehicle 'fully_actuated'",
     {"vehicle.model=fully_actuated"}},
    {"field",
     {},
     "control.attitude_gain=9",
     "vehicle 'fully_actuated'",
     {"vehicle.model=fully_actuated"}},
    {"utracking",
     {},
     "control.rate_gain=9",
     "vehicle 'fully_actuated'; this configuration chose 'kinematic'",
     {"vehicle.model=fully_actuated"}},
    {"field",
     {},
     "control.heading=along_velocity",
     "vehicle 'fully_actuated'",
     {"vehicle.model=fully_actuated"}},
    {"utracking",
     {},
     "vehicle.integrator=rk4",
     "vehicle 'fully_actuated' or 'torpedo'; this configuration chose 'kinematic'",
     {"vehicle.models=[kinematic, torpedo]"}},
    {"field",
     {},
     "vehicle.clip_velocity=true",
     "vehicle 'fully_actuated'; this",
     {"vehicle.model=fully_actuated"}},
    {"utracking", {}, "vehicle.substeps=2", "or 'torpedo'", {"vehicle.model=torpedo"}},
    {"utracking", {}, "disturbance.force_std_n=5", "or 'torpedo'", {"vehicle.model=torpedo"}},
    {"utracking", {}, "disturbance.moment_std_nm=5", "or 'torpedo'", {"vehicle.model=torpedo"}},
    {"utracking", {}, "contact.stiffness=5", "or 'torpedo'", {"vehicle.model=torpedo"}},
    {"utracking",
     {},
     "control.autopilot.max_pitch_rad=0.1",
     "vehicle 'torpedo'",
     {"vehicle.model=torpedo"}},
    {"medium",
     {"vehicle.models=[fully_actuated]"},
     "vehicle.model=torpedo",
     "fleet 'of one model'; this configuration chose 'of models in turn' (vehicle.models",
     {"vehicle.models=[]"}},
    {"medium",
     {"control.interface=tau6"},
     "control.max_delta=0.1",
     "action interface 'velocity3'; this configuration chose 'tau6' (control.interface",
     {"control.interface=velocity3"}},
    {"medium",
     {"control.interface=tau6"},
     "control.smoothing=0.1",
     "action interface 'velocity3'",
     {"control.interface=velocity3"}},
    {"medium",
     {},
     "control.heading_gain=1",
     "heading 'along_velocity'; this configuration chose 'free' (control.heading",
     {"control.heading=along_velocity"}},
    {"medium_release",
     {},
     "vehicle.fully_actuated.weight_n=100",
     "vehicle 'with restoring forces'",
     {"vehicle.fully_actuated.restoring=true"}},
    {"medium",
     {},
     "reset.stages.hard.target_speed_mps=[0.01, 0.02]",
     "reset stage 'hard'; this configuration chose 'medium' (reset.stage",
     {"reset.stage=hard"}},
    {"medium",
     {},
     "reset.stages.easy.auv_distance_m=[0.1, 0.2]",
     "reset stage 'easy'",
     {"reset.curriculum=true"}},
    {"many8",
     {},
     "reset.stages.medium.auv_distance_m=[200, 300]",
     "start 'around' or 'point'; this configuration chose 'area' (reset.deploy",
     {"reset.deploy=point"}},
    {"medium",
     {},
     "target.max_turn_rate_radps=0.1",
     "or 'evasive'; this configuration chose 'constant_velocity' (target.motion",
     {"target.motion=evasive"}},
    {"field",
     {},
     "contact.softness_m=0.5",
     "contact 'with a force'; this configuration chose 'without a force' (contact.stiffness",
     {"contact.stiffness=1"}},
    {"medium",
     {},
     "disturbance.correlation_time_s=5",
     "this configuration chose 'none' (disturbance.force_std_n",
     {"disturbance.moment_std_nm=1"}},
    {"medium",
     {},
     "current.layer_depth_m=[0, 1, 2, 3]",
     "current 'in layers'",
     {"current.layer_north_mps=[0, 0, 1, 0]"}},
    {"medium",
     {},
     "current.layer_depth_m=[0, 1, 2, 3]",
     "current 'in layers'",
     {"current.random_mps=[0, 1]"}},
    {"medium",
     {},
     "current.tide_period_s=100",
     "current 'with a tide'",
     {"current.tide_mps=[0, 1]"}},
    {"deep",
     {"current.random_tide_mps=0"},
     "current.tide_period_s=100",
     "chose 'without a tide' (current.",
     {"current.random_tide_mps=0.1"}},
    {"deep",
     {},
     "current.tide_phase_rad=1",
     "current 'with a given tide'",
     {"current.tide_mps=[1, 0]"}},
    {"medium",
     {},
     "sensing.dropout_duration_s=5",
     "target sensor 'with blind spells'",
     {"sensing.dropout_rate_hz=0.1"}},
    {"deep",
     {},
     "navigation.dead_reckoning.gps_std_m=5",
     "navigation 'with GPS'",
     {"navigation.dead_reckoning.gps_depth_m=1", "navigation.dead_reckoning.fixes=reported"}},
};

TEST(WorldKeys, AreRefusedExceptBesideTheChoiceThatReadsThem) {
  for (const Case& c : kCases) {
    const std::string message = ErrorOf([&] { Load(c.scenario, Joined(c.choice, {c.key})); });
    const std::string path = c.key.substr(0, c.key.find('='));
    EXPECT_NE(message.find(": " + path + ": belongs to the "), std::string::npos) << message;
    EXPECT_NE(message.find(c.why), std::string::npos) << message << "\nexpected: " << c.why;
    EXPECT_NO_THROW(Load(c.scenario, Joined(Joined(c.choice, c.cure), {c.key}))) << c.key;
  }
}

/// The choice stands in two keys, and the one that was set last decides what a base may state.
TEST_F(ScenarioInput, AFleetOfSeveralModelsIgnoresKeysThatABaseStatesForItsOneModel) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const Scenario fleet = LoadScenario(base, {}, {"vehicle.models=[torpedo, kinematic]"});
  EXPECT_EQ(fleet.world.vehicle.model_of(1), "kinematic");
  const Keys mass{"vehicle.fully_actuated.mass_kg=30", "vehicle.models=[torpedo]"};
  EXPECT_NE(ErrorOf([&] {
              LoadScenario(base, {}, mass);
            }).find("chose 'torpedo' (vehicle.model, vehicle.models)"),
            std::string::npos);
}

/// Files state all stages, because conditions and commands choose another one on top of them.
TEST_F(ScenarioInput, StagesThatWereNotChosenStayInFiles) {
  const Scenario field = Load("field", {});
  const std::string saved = Write("saved.yaml", ToYaml(field));
  const Scenario hard = LoadScenario(saved, {}, {"reset.stage=hard"});
  EXPECT_EQ(hard.world.reset.stages[2].auv_distance_m.lo, 500.0);
  const std::string overlay =
      Write("overlay.yaml", "reset:\n  stages:\n    hard:\n      auv_distance_m: [600, 700]\n");
  EXPECT_EQ(LoadScenario(saved, {overlay}).world.reset.stages[2].auv_distance_m.lo, 600.0);
  // Only the stages that are used must fit into the water.
  const Keys narrow{"reset.start_half_extent_m=450"};
  EXPECT_NO_THROW(LoadScenario(saved, {}, narrow));
  EXPECT_NE(ErrorOf([&] {
              LoadScenario(saved, {}, Joined(narrow, {"reset.curriculum=true"}));
            }).find("reset.stages.hard.auv_distance_m"),
            std::string::npos);
}

TEST_F(ScenarioInput, TheSeedOfASimulationIsNoOverride) {
  const std::string message = ErrorOf([&] { Load("medium", {"seed=5"}); });
  EXPECT_EQ(message.rfind("--set 'seed=5': seed: a simulation does not read this key", 0), 0u)
      << message;
  EXPECT_NE(message.find("--seed"), std::string::npos) << message;
  // A file may state the seed, because channel.launch reads the same file.
  const std::string overlay = Write("overlay.yaml", "seed: 5\n");
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  EXPECT_EQ(LoadScenario(base, {overlay}).run.seed, 5u);
}

}  // namespace
}  // namespace stg::scenario_test

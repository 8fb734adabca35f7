#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "auv_common/config/loader.hpp"
#include "scenario/scenario_fields.hpp"
#include "scenario/scenario_input.hpp"

namespace stg::scenario_test {
namespace {

TEST_F(ScenarioInput, WrongTypesAreRefused) {
  ExpectRefused("dt_s", "dt_s: fast", "time.dt_s", "expected a number, found 'fast'");
  ExpectRefused("dt_s", "dt_s: \"0.1\"", "time.dt_s", "expected a number");
  ExpectRefused("dt_s", "dt_s: 0.1s", "time.dt_s", "expected a number");
  ExpectRefused("dt_s", "dt_s: [0.1]", "time.dt_s", "found a sequence");
  ExpectRefused("dt_s", "dt_s:", "time.dt_s", "found nothing");
  ExpectRefused("dt_s", "dt_s: {a: 1}", "time.dt_s", "found a map");
  ExpectRefused("agents", "agents: 4.5", "agents", "expected an integer, found '4.5'");
  ExpectRefused("agents", "agents: true", "agents", "expected an integer");
  ExpectRefused("seed", "seed: -1", "seed", "out of range: expected a whole number from 0");
  ExpectRefused("seed", "seed: 18446744073709551616", "seed", "out of range");
  ExpectRefused("restoring", "restoring: yes", "vehicle.fully_actuated.restoring",
                "expected true or false");
  ExpectRefused("restoring", "restoring: 1", "vehicle.fully_actuated.restoring",
                "expected true or false");
  ExpectRefused("name", "name: [a]", "name", "expected a name");
  ExpectRefused("name", "name: ../etc", "name", "not a name");
  ExpectRefused("max_tau", "max_tau: [1, 2, 3]", "vehicle.max_tau",
                "expected a sequence of 6 numbers, found 3 items");
  ExpectRefused("max_tau", "max_tau: 3", "vehicle.max_tau", "expected a sequence of 6 numbers");
  ExpectRefused("max_tau", "max_tau: [1, 2, 3, 4, 5, x]", "vehicle.max_tau", "found 'x'");
  ExpectRefused("band_m", "band_m: [0.01]", "reward.band_m", "sequence of 2 numbers");
}

TEST_F(ScenarioInput, ValueInPlaceOfASectionIsRefused) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  for (const std::string value : {"3", "[1, 2, 3]"}) {
    const std::string overlay = Write("overlay.yaml", "agents: 3\ncurrent: " + value + "\n");
    const std::string message = ErrorOf([&] { LoadScenario(base, {overlay}); });
    EXPECT_EQ(message.rfind(overlay + ":2: current: expected a map of keys, found ", 0), 0u)
        << message;
  }
}

TEST_F(ScenarioInput, WrongEnumerationValueListsTheAllowedOnes) {
  ExpectRefused("mode", "mode: turth", "mode", "expected one of truth | acoustic, found 'turth'");
  ExpectRefused("integrator", "integrator: euler", "vehicle.integrator", "semi_implicit | rk4");
  ExpectRefused("stage", "stage: 1", "reset.stage", "easy | medium | hard");
}

TEST_F(ScenarioInput, NonFiniteNumbersAreRefused) {
  for (const char* text : {".nan", ".NaN", "nan", ".inf", "-.inf", "inf", "-Infinity", "1e999"}) {
    ExpectRefused("mass_kg", std::string("mass_kg: ") + text, "vehicle.fully_actuated.mass_kg",
                  text);
    ExpectRefused("r_BG_m", std::string("r_BG_m: [0, 0, ") + text + "]",
                  "vehicle.fully_actuated.r_BG_m", text);
    ExpectRefused("band_m", std::string("band_m: [0.01, ") + text + "]", "reward.band_m", text);
  }
}

/// Sets every number in the file just outside each of its bounds.
TEST_F(ScenarioInput, EveryNumberIsRefusedOutsideItsRange) {
  int checked = 0;
  for (const bool above : {false, true}) {
    const std::size_t count = [] {
      Scenario s;
      return ScenarioFields(&s).size();
    }();
    for (std::size_t i = 0; i < count; ++i) {
      Scenario s;
      const config::Field field = ScenarioFields(&s)[i];
      const double edge = above ? field.limits.hi : field.limits.lo;
      const double step = 1e-6 * (1.0 + std::abs(edge));
      const double value = above ? edge + step : (field.limits.lo_excluded ? edge : edge - step);
      if (auto v = std::get_if<double*>(&field.value)) {
        **v = value;
      } else if (auto v = std::get_if<int*>(&field.value)) {
        **v = static_cast<int>(edge) + (above ? 1 : -1);
      } else if (auto v = std::get_if<config::NumbersRef>(&field.value)) {
        v->data[v->size - 1] = value;
      } else if (auto v = std::get_if<config::Interval*>(&field.value)) {
        (above ? (*v)->hi : (*v)->lo) = value;
      } else {
        continue;
      }
      ++checked;
      if (field.Unchosen() != nullptr) {
        Scenario other;
        const std::string text = field.path + "=" + config::FormatValue(field.value);
        const std::string message = ErrorOf([&] { config::Override(&other, {text}); });
        EXPECT_NE(message.find("out of range"), std::string::npos) << message;
        continue;
      }
      const std::string file = Write("range.yaml", ToYaml(s));
      const std::string in_file = ErrorOf([&] { LoadScenario(file); });
      EXPECT_EQ(in_file.rfind(file + ":", 0), 0u) << in_file;
      EXPECT_NE(in_file.find(": " + field.path + ": "), std::string::npos) << in_file;
      EXPECT_NE(in_file.find("out of range"), std::string::npos) << in_file;
      const std::string in_struct = ErrorOf([&] { s.ValidateOrThrow(); });
      EXPECT_NE(in_struct.find(field.path), std::string::npos) << in_struct;
    }
  }
  EXPECT_GT(checked, 150);
}

TEST(Scenario, StructWithNanIsRefused) {
  Scenario scenario;
  EXPECT_NO_THROW(scenario.ValidateOrThrow());
  scenario.world.current.velocity_mps[1] = std::nan("");
  EXPECT_NE(ErrorOf([&] { scenario.ValidateOrThrow(); }).find("current.velocity_mps"),
            std::string::npos);
}

TEST_F(ScenarioInput, ContradictionNamesAllItsKeysWhereTheyWereGiven) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::string overlay = Write("overlay.yaml", "time:\n  tail_steps: 60\n");
  const std::string message =
      ErrorOf([&] { LoadScenario(base, {overlay}, {"time.episode_steps=50"}); });
  EXPECT_EQ(message.rfind(overlay + ":2: time.tail_steps: ", 0), 0u) << message;
  EXPECT_NE(message.find("--set 'time.episode_steps=50'"), std::string::npos) << message;
}

TEST_F(ScenarioInput, KeysThatContradictEachOtherAreRefused) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"time.dt_s=0.10000000004"}, "time.dt_s"},
      {{"target.count=5"}, "target.count"},
      {{"vehicle.fully_actuated.r_BG_m=[0, 0, 5]"}, "vehicle.fully_actuated.r_BG_m"},
      {{"vehicle.radius_m=2"}, "vehicle.radius_m"},
      {{"reset.start_half_extent_m=1.5"}, "reset.start_half_extent_m"},
      {{"reset.curriculum=true", "reset.curriculum_medium_resets=10"},
       "reset.curriculum_medium_resets"},
      {{"reset.stage=hard", "workspace.half_extent_m=0.7", "reset.start_half_extent_m=0.7"},
       "reset.stages.hard.target_radius_m"},
      {{"reset.stage=hard", "target.max_speed_mps=0.01"}, "reset.stages.hard.target_speed_mps"},
      {{"reset.curriculum=true", "reset.start_half_extent_m=0.3"},
       "reset.stages.hard.auv_distance_m"},
      {{"reset.min_separation_m=1"}, "agents"},
      {{"channel.periodic.transmit_period_s=0.05"}, "channel.periodic.transmit_period_s"},
      {{"observation.quality_medium=0.9"}, "observation.quality_medium"},
      {{"reward.band_m=[0.02, 0.01]"}, "reward.band_m"},
      {{"task.lost_distance_m=0.01"}, "task.lost_distance_m"},
      {{"reward.weights.separation=1", "reward.separation_distance_m=0.02"},
       "reward.separation_distance_m"},
  };
  for (const auto& [overrides, key] : cases) {
    const std::string message = ErrorOf([&] { LoadScenario(base, {}, overrides); });
    EXPECT_NE(message.find(": " + key + ": "), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace stg::scenario_test

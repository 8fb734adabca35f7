#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "scenario_fields.hpp"

namespace stg {
namespace {

namespace fs = std::filesystem;

/// Message of the UserError that `call` throws; fails when it throws none.
template <class F>
std::string ErrorOf(F call) {
  try {
    call();
  } catch (const UserError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no UserError";
  return "";
}

/// A folder for each test with files that the test writes.
class ScenarioInput : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "scenario_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }

  /// The whole file with the line of `key` (its leaf) replaced; `line` is told.
  static std::string WithLine(const std::string& key, const std::string& replacement, int* line) {
    std::istringstream in(ToYaml(Scenario{}));
    std::string out;
    int number = 0;
    *line = 0;
    for (std::string text; std::getline(in, text);) {
      ++number;
      const auto start = text.find_first_not_of(' ');
      if (*line == 0 && text.compare(start, key.size() + 1, key + ":") == 0) {
        *line = number;
        text = text.substr(0, start) + replacement;
      }
      out += text + "\n";
    }
    EXPECT_GT(*line, 0) << key;
    return out;
  }

  /// Loads the file with one line replaced and expects an error that names
  /// file, line, key and says `what`.
  void ExpectRefused(const std::string& leaf, const std::string& replacement,
                     const std::string& path, const std::string& what) {
    int line = 0;
    const std::string file = Write("bad.yaml", WithLine(leaf, replacement, &line));
    const std::string message = ErrorOf([&] { LoadScenario(file); });
    const std::string start = file + ":" + std::to_string(line) + ": " + path + ": ";
    EXPECT_EQ(message.substr(0, start.size()), start) << replacement;
    EXPECT_NE(message.find(what), std::string::npos) << message << "\nexpected: " << what;
  }

  fs::path folder_;
};

TEST_F(ScenarioInput, RoundTripThroughYamlKeepsEveryValueExactly) {
  Scenario scenario;
  scenario.vehicle.mass_kg = 0.1 + 0.2;  // needs all 17 digits
  scenario.seed = std::numeric_limits<std::uint64_t>::max();
  scenario.sensing.noise_std_m = 1e-300;
  scenario.vehicle.added_mass_coriolis = dynamics::AddedMassCoriolis::kOff;
  scenario.control.interface = dynamics::ActionInterface::kTau6;
  scenario.reset.stages[2].target_radius_m = {1.0 / 3.0, 2.0 / 3.0};
  scenario.name = "off";
  const Scenario loaded = LoadScenario(Write("a.yaml", ToYaml(scenario)));
  EXPECT_EQ(loaded.vehicle.mass_kg, scenario.vehicle.mass_kg);
  EXPECT_EQ(loaded.seed, scenario.seed);
  EXPECT_EQ(loaded.sensing.noise_std_m, 1e-300);
  EXPECT_EQ(loaded.vehicle.added_mass_coriolis, dynamics::AddedMassCoriolis::kOff);
  EXPECT_EQ(loaded.control.interface, dynamics::ActionInterface::kTau6);
  EXPECT_EQ(loaded.reset.stages[2].target_radius_m.lo, 1.0 / 3.0);
  EXPECT_EQ(loaded.name, "off");
  EXPECT_EQ(ToYaml(loaded), ToYaml(scenario));
}

TEST_F(ScenarioInput, EveryMissingKeyIsNamedWithTheLineOfItsSection) {
  Scenario scenario;
  for (const config::Field& field : ScenarioFields(&scenario)) {
    if (field.fallback) continue;  // need not be stated
    const std::string yaml = ToYaml(scenario);
    std::istringstream in(yaml);
    std::string without, section;
    std::vector<std::string> open;
    int number = 0, section_line = 1;
    for (std::string text; std::getline(in, text);) {
      ++number;
      const auto depth = text.find_first_not_of(' ') / 2;
      const std::string key = text.substr(2 * depth, text.find(':') - 2 * depth);
      open.resize(depth);
      open.push_back(key);
      std::string path;
      for (const std::string& part : open) path += (path.empty() ? "" : ".") + part;
      if (field.path.rfind(path + ".", 0) == 0) section_line = number;
      // An emptied line keeps the numbers of the others.
      without += (path == field.path ? "" : text) + "\n";
    }
    const std::string file = Write("missing.yaml", without);
    const std::string message = ErrorOf([&] { LoadScenario(file); });
    const std::string start = file + ":" + std::to_string(section_line) + ": " + field.path;
    if (field.path != "name") {  // there the document starts one line later
      EXPECT_EQ(message.substr(0, start.size()), start);
    }
    EXPECT_NE(message.find(field.path + ": missing key"), std::string::npos) << message;
  }
}

TEST_F(ScenarioInput, UnknownKeySuggestsTheNearest) {
  ExpectRefused("dt_s", "dt: 0.1", "time.dt", "unknown key, did you mean time.dt_s?");
  ExpectRefused("agents", "agent: 4", "agent", "unknown key, did you mean agents?");
  ExpectRefused("mode", "dt_s: 0.1", "dt_s", "unknown key, did you mean time.dt_s?");
  ExpectRefused("mode", "zzzzzzzzzz: 1", "zzzzzzzzzz", "unknown key");
}

TEST_F(ScenarioInput, DuplicateKeyNamesBothLines) {
  int line = 0;
  std::string text = WithLine("episode_steps", "dt_s: 0.2", &line);
  const std::string file = Write("twice.yaml", text);
  const std::string message = ErrorOf([&] { LoadScenario(file); });
  EXPECT_EQ(message, file + ":" + std::to_string(line) +
                         ": time.dt_s: duplicate key, first given in line " +
                         std::to_string(line - 2));
}

TEST_F(ScenarioInput, WrongTypesAreRefused) {
  ExpectRefused("dt_s", "dt_s: fast", "time.dt_s", "expected a number, found 'fast'");
  ExpectRefused("dt_s", "dt_s: \"0.1\"", "time.dt_s", "expected a number");
  ExpectRefused("dt_s", "dt_s: 0.1s", "time.dt_s", "expected a number");
  ExpectRefused("dt_s", "dt_s: [0.1]", "time.dt_s", "found a sequence");
  ExpectRefused("dt_s", "dt_s:", "time.dt_s", "found nothing");
  ExpectRefused("dt_s", "dt_s: {a: 1}", "time.dt_s", "found a map");
  ExpectRefused("agents", "agents: 4.5", "agents", "expected an integer, found '4.5'");
  ExpectRefused("agents", "agents: true", "agents", "expected an integer");
  ExpectRefused("seed", "seed: -1", "seed", "out of range");
  ExpectRefused("seed", "seed: 18446744073709551616", "seed", "out of range");
  ExpectRefused("restoring", "restoring: yes", "vehicle.restoring", "expected true or false");
  ExpectRefused("restoring", "restoring: 1", "vehicle.restoring", "expected true or false");
  ExpectRefused("name", "name: [a]", "name", "expected a name");
  ExpectRefused("name", "name: ../etc", "name", "no name");
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
    ExpectRefused("mass_kg", std::string("mass_kg: ") + text, "vehicle.mass_kg", text);
    ExpectRefused("r_BG_m", std::string("r_BG_m: [0, 0, ") + text + "]", "vehicle.r_BG_m", text);
    ExpectRefused("band_m", std::string("band_m: [0.01, ") + text + "]", "reward.band_m", text);
  }
}

/// Every number just outside each of its bounds, in the file.
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
  scenario.current.velocity_mps[1] = std::nan("");
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
      {{"vehicle.r_BG_m=[0, 0, 5]"}, "vehicle.r_BG_m"},
      {{"vehicle.radius_m=2"}, "vehicle.radius_m"},
      {{"reset.start_half_extent_m=1.5"}, "reset.start_half_extent_m"},
      {{"reset.curriculum_medium_resets=10"}, "reset.curriculum_medium_resets"},
      {{"workspace.half_extent_m=0.7", "reset.start_half_extent_m=0.7"},
       "reset.stages.hard.target_radius_m"},
      {{"target.max_speed_mps=0.01"}, "reset.stages.hard.target_speed_mps"},
      {{"reset.start_half_extent_m=0.3"}, "reset.stages.hard.auv_distance_m"},
      {{"reset.min_separation_m=1"}, "agents"},
      {{"channel.transmit_period_s=0.05"}, "channel.transmit_period_s"},
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

TEST_F(ScenarioInput, OverridesAreAppliedInOrderAfterOverlays) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::string overlay = Write("overlay.yaml", "agents: 6\n");
  EXPECT_EQ(LoadScenario(base, {overlay}).agents, 6);
  EXPECT_EQ(LoadScenario(base, {overlay}, {"agents=7", "agents=8"}).agents, 8);
  const Scenario s = LoadScenario(base, {}, {"reward.band_m=[0.011, 0.014]", "mode=truth"});
  EXPECT_EQ(s.reward.band_m.lo, 0.011);
  EXPECT_EQ(s.mode, InformationMode::kTruth);
}

TEST_F(ScenarioInput, RefusedOverrideIsNamed) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::pair<std::string, std::string> cases[] = {
      {"agents", "expected key.path=value"},
      {"=4", "expected key.path=value"},
      {"agent=4", "agent: unknown key, did you mean agents?"},
      {"time=4", "time: names a section"},
      {"agents=", "agents: expected an integer, found nothing"},
      {"agents=many", "agents: expected an integer, found 'many'"},
      {"agents=0", "agents: 0 is out of range"},
      {"agents=[4", "agents: not valid"},
      {"agents=4\nseed: 3", "agents: "},
      {"base=other.yaml", "base: unknown key"},
      {"time.dt_s=.nan", "time.dt_s: must be a finite number"},
  };
  for (const auto& [text, what] : cases) {
    const std::string message = ErrorOf([&, t = text] { LoadScenario(base, {}, {t}); });
    EXPECT_EQ(message.rfind("--set '" + text.substr(0, text.find('\n')), 0), 0u) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
  }
}

/// A key of an earlier version is refused with the name that it has now.
TEST_F(ScenarioInput, AMovedKeyNamesItsNewPlace) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::pair<const char*, const char*> moved[] = {
      {"reward.desired_distance_m", "task.desired_distance_m"},
      {"reward.lost_distance_m", "task.lost_distance_m"},
      {"observation.link_radius_m", "channel.range_m"},
  };
  for (const auto& [from, to] : moved) {
    const std::string message =
        ErrorOf([&, key = std::string(from)] { LoadScenario(base, {}, {key + "=0.5"}); });
    EXPECT_NE(message.find(std::string(from) + ": this key is called " + to), std::string::npos)
        << message;
  }
}

}  // namespace
}  // namespace stg

#include "stg_env/scenario/scenario.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"
#include "scenario/scenario_fields.hpp"
#include "scenario/scenario_input.hpp"

namespace stg::scenario_test {
namespace {

TEST_F(ScenarioInput, RoundTripThroughYamlKeepsEveryValueExactly) {
  Scenario scenario;
  scenario.world.vehicle.mass_kg = 0.1 + 0.2;  // this number needs all 17 digits
  scenario.run.seed = std::numeric_limits<std::uint64_t>::max();
  scenario.world.sensing.noise_std_m = 1e-300;
  scenario.world.vehicle.added_mass_coriolis = dynamics::AddedMassCoriolis::kOff;
  scenario.world.control.interface = dynamics::ActionInterface::kTau6;
  scenario.world.reset.stages[2].target_radius_m = {1.0 / 3.0, 2.0 / 3.0};
  scenario.run.name = "off";
  const Scenario loaded = LoadScenario(Write("a.yaml", ToYaml(scenario)));
  EXPECT_EQ(loaded.world.vehicle.mass_kg, scenario.world.vehicle.mass_kg);
  EXPECT_EQ(loaded.run.seed, scenario.run.seed);
  EXPECT_EQ(loaded.world.sensing.noise_std_m, 1e-300);
  EXPECT_EQ(loaded.world.vehicle.added_mass_coriolis, dynamics::AddedMassCoriolis::kOff);
  EXPECT_EQ(loaded.world.control.interface, dynamics::ActionInterface::kTau6);
  EXPECT_EQ(loaded.world.reset.stages[2].target_radius_m.lo, 1.0 / 3.0);
  EXPECT_EQ(loaded.run.name, "off");
  EXPECT_EQ(ToYaml(loaded), ToYaml(scenario));
}

/// Sets another allowed value of the same type. False if there is none.
bool Change(const config::Field& field) {
  const auto other = [&](double v) {
    const double middle = 0.5 * (field.limits.lo + field.limits.hi);
    return v == middle ? 0.75 * middle + 0.25 * field.limits.hi : middle;
  };
  if (auto v = std::get_if<double*>(&field.value)) **v = other(**v);
  if (auto v = std::get_if<int*>(&field.value)) **v += 1;
  if (auto v = std::get_if<std::uint64_t*>(&field.value)) **v += 1;
  if (auto v = std::get_if<bool*>(&field.value)) **v = !**v;
  if (auto v = std::get_if<std::string*>(&field.value)) **v += "x";
  if (auto v = std::get_if<config::NameOrFileRef>(&field.value)) *v->text += "x";
  if (auto v = std::get_if<config::EnumRef>(&field.value)) {
    if (v->names.size() == 1) return false;
    v->set((v->get() + 1) % static_cast<int>(v->names.size()));
  }
  if (auto v = std::get_if<config::NumbersRef>(&field.value)) v->data[v->size - 1] += 0.5;
  if (auto v = std::get_if<config::Interval*>(&field.value)) (*v)->hi += 0.5;
  if (auto v = std::get_if<config::RowsRef>(&field.value)) {
    v->rows->emplace_back(static_cast<std::size_t>(v->columns), 1.0);
  }
  if (auto v = std::get_if<config::NamesRef>(&field.value)) v->list->push_back(v->names[0]);
  if (auto v = std::get_if<config::DifferenceRef>(&field.value)) {
    const std::string truth = config::FormatValue(v->of->value);
    if (!Change(*v->of)) return false;
    v->all->emplace(v->of->path, config::FormatValue(v->of->value));
    config::ParseValue(*v->of, config::ParseYaml(truth, "text", false));
  }
  return true;
}

TEST(Scenario, HashAndFileChangeWithEveryKey) {
  Scenario scenario;
  std::set<std::string> hashes{ScenarioHash(scenario)};
  const std::size_t count = ScenarioFields(&scenario).size();
  std::size_t fixed = 0, unread = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Scenario changed;
    const config::Field field = ScenarioFields(&changed)[i];
    if (!Change(field)) {
      ++fixed;
      continue;
    }
    if (!field.InFiles()) {
      ++unread;
      EXPECT_EQ(ScenarioHash(changed), ScenarioHash(scenario)) << field.path;
      continue;
    }
    EXPECT_TRUE(hashes.insert(ScenarioHash(changed)).second) << field.path;
  }
  EXPECT_EQ(hashes.size(), count - fixed - unread + 1);
  EXPECT_LT(fixed, 4u) << "keys with one value only";
  EXPECT_EQ(ScenarioHash(scenario), ScenarioHash(Scenario{}));
}

TEST_F(ScenarioInput, EveryMissingKeyIsNamedWithTheLineOfItsSection) {
  Scenario scenario;
  for (const config::Field& field : ScenarioFields(&scenario)) {
    if (field.fallback || !field.InFiles()) continue;  // a file may leave it out
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
      // An emptied line keeps the line numbers of the others.
      without += (path == field.path ? "" : text) + "\n";
    }
    const std::string file = Write("missing.yaml", without);
    const std::string message = ErrorOf([&] { LoadScenario(file); });
    const std::string start = file + ":" + std::to_string(section_line) + ": " + field.path;
    if (field.path != "name") {  // without `name` the document starts one line later
      EXPECT_EQ(message.substr(0, start.size()), start);
    }
    EXPECT_NE(message.find(field.path + ": missing key"), std::string::npos) << message;
  }
}

TEST_F(ScenarioInput, UnknownKeySuggestsTheNearest) {
  ExpectRefused("dt_s", "dt: 0.1", "time.dt", "unknown key, did you mean time.dt_s?");
  ExpectRefused("range_m", "rnge: 0.3", "sensing.rnge",
                "unknown key, did you mean sensing.range_m?");
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

TEST_F(ScenarioInput, OverridesAreAppliedAfterOverlays) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::string overlay = Write("overlay.yaml", "agents: 6\n");
  EXPECT_EQ(LoadScenario(base, {overlay}).run.agents, 6);
  EXPECT_EQ(LoadScenario(base, {overlay}, {"agents=7"}).run.agents, 7);
  const Scenario s = LoadScenario(base, {}, {"reward.band_m=[0.011, 0.014]", "mode=truth"});
  EXPECT_EQ(s.reward.band_m.lo, 0.011);
  EXPECT_EQ(s.mode, InformationMode::kTruth);
}

TEST_F(ScenarioInput, AKeyThatTwoOverridesSetIsRefused) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::vector<std::string> overrides = {"agents=7", "seed=1", "agents=8"};
  const std::string expected =
      "--set 'agents=8': agents: is also set by --set 'agents=7'; leave out one of the two";
  Scenario scenario;
  for (const auto& set : {std::function<void()>([&] { LoadScenario(base, {}, overrides); }),
                          std::function<void()>([&] { config::Override(&scenario, overrides); })}) {
    try {
      set();
      ADD_FAILURE();
    } catch (const UserError& error) {
      EXPECT_EQ(std::string(error.what()), expected);
    }
  }
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

/// A key of an earlier version is refused, and the message names the key of today.
TEST_F(ScenarioInput, AMovedKeyNamesItsNewPlace) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::pair<const char*, const char*> moved[] = {
      {"reward.desired_distance_m", "task.desired_distance_m"},
      {"reward.lost_distance_m", "task.lost_distance_m"},
      {"observation.link_radius_m", "channel.range_m"},
      {"channel.loss_probability", "channel.extended.loss_probability"},
      {"channel.modem.profile", "channel.physical.modem.profile"},
      {"vehicle.mass_kg", "vehicle.fully_actuated.mass_kg"},
      {"sensing.range_std_m", "sensing.range.range_std_m"},
      {"navigation.dvl_noise_mps", "navigation.dead_reckoning.dvl_noise_mps"},
      {"target.evasion_range_m", "target.evasive.range_m"},
      {"reward.terms.spread", "reward.terms.spread.weight"},
  };
  for (const auto& [from, to] : moved) {
    const std::string message =
        ErrorOf([&, key = std::string(from)] { LoadScenario(base, {}, {key + "=0.5"}); });
    EXPECT_NE(message.find(std::string(from) + ": this key is called " + to), std::string::npos)
        << message;
  }
}

/// A scenario must not set a key of a thing that it did not choose. The scenarios here choose
/// differently.
TEST_F(ScenarioInput, AKeyOfAThingThatWasNotChosenIsRefusedWithTheChoice) {
  for (const char* name : {"medium", "field", "physical", "utracking", "medium_release"}) {
    const Scenario scenario = LoadNamedScenario(STG_SCENARIO_FOLDER, name);
    Scenario copy = scenario;
    int refused = 0;
    for (const config::Field& field : ScenarioFields(&copy)) {
      const config::Owner* owner = field.Unchosen();
      if (owner == nullptr || !owner->refusal.empty()) continue;
      ++refused;
      const auto* of_model = std::get_if<config::DifferenceRef>(&field.value);
      const std::string value =
          config::FormatValue(of_model != nullptr ? of_model->of->value : field.value);
      const std::string text = field.path + "=" + value;
      const std::string message =
          ErrorOf([&] { LoadNamedScenario(STG_SCENARIO_FOLDER, name, "nominal", {text}); });
      EXPECT_EQ(message.rfind("--set '" + field.path.substr(0, 50), 0), 0u) << message;
      EXPECT_NE(message.find(field.path + ": belongs to the " + owner->kind), std::string::npos)
          << message;
      EXPECT_NE(message.find("; this configuration chose "), std::string::npos) << message;
    }
    EXPECT_GT(refused, 40) << name;
  }
}

TEST_F(ScenarioInput, WhatNeitherTheModeNorTheWorldNorTheTrainingReadsIsRefused) {
  const auto load = [](const std::vector<std::string>& keys) {
    LoadNamedScenario(STG_SCENARIO_FOLDER, "medium", "nominal", keys);
  };
  const auto expect_refused = [&](const std::vector<std::string>& keys, const std::string& why) {
    const std::string message = ErrorOf([&] { load(keys); });
    EXPECT_NE(message.find("belongs to the " + why), std::string::npos) << message;
  };
  for (const char* key : {"track.gate_sigma=3", "sensing.detection_probability=0.5",
                          "channel.extended.loss_probability=1"}) {
    load({key});
    expect_refused({"mode=truth", key},
                   "information mode 'acoustic'; this configuration chose 'truth' (mode)");
  }
  load({"mode=truth", "sensing.range_m=0.3", "channel.range_m=0.3"});
  expect_refused({"sea.bottom_m=90"},
                 "world 'open water'; this configuration chose 'walls' (sea.open)");
  load({"sea.open=false"});
  expect_refused({"reset.curriculum_easy_resets=10"},
                 "training 'curriculum'; this configuration chose 'one stage' (reset.curriculum)");
  load({"reset.curriculum=true", "reset.curriculum_easy_resets=10"});
}

TEST_F(ScenarioInput, KeysOfABaseArePassedOverWhereAnotherThingIsChosenOnTopOfIt) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));  // it chooses `extended`
  const std::string choice = "base: base.yaml\nchannel:\n  model: range\n";
  EXPECT_EQ(LoadScenario(Write("other.yaml", choice)).channel.model, "range");
  // These keys have no effect in the file that chooses, in an overlay and in an override.
  const std::string key = "  extended:\n    loss_probability: 1.0\n";
  const std::string said =
      "channel.extended.loss_probability: belongs to the propagation model "
      "'extended'; this configuration chose 'range' (channel.model)";
  const std::string same = Write("same.yaml", choice + key);
  EXPECT_EQ(ErrorOf([&] { LoadScenario(same); }), same + ":5: " + said);
  const std::string overlay = Write("overlay.yaml", "channel:\n" + key);
  EXPECT_EQ(ErrorOf([&] { LoadScenario(base, {overlay}, {"channel.model=range"}); }),
            overlay + ":3: " + said);
  EXPECT_EQ(LoadScenario(base, {overlay}).channel.extended.loss_probability, 1.0);
}

}  // namespace
}  // namespace stg::scenario_test

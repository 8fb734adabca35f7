// Long because: tests of the shipped files and of the reference share what reads their keys.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "scenario/scenario_fields.hpp"

/// The shipped scenario files and the reference of their keys.
namespace stg {
namespace {

namespace fs = std::filesystem;
const std::string kFolder = STG_SCENARIO_FOLDER;
const std::string kReference = STG_SCENARIO_REFERENCE;
const char* const kConditions[] = {"nominal",
                                   "fast_target",
                                   "far_initialization",
                                   "limited_sensing",
                                   "degraded_communication",
                                   "combined_stress"};

std::vector<std::string> Names(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().stem().string());
  }
  return names;
}

std::string ReadText(const std::string& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(ShippedScenarios, EveryFileLoadsUnderItsOwnName) {
  const auto names = Names(kFolder);
  EXPECT_GE(names.size(), 6u);
  for (const std::string& name : names) {
    EXPECT_EQ(LoadNamedScenario(kFolder, name).run.name, name);
  }
}

TEST(ShippedScenarios, EveryConditionAppliesToEveryScenarioAndChangesIt) {
  for (const std::string& name : Names(kFolder)) {
    std::set<std::string> hashes;
    for (const char* condition : kConditions) {
      hashes.insert(ScenarioHash(LoadNamedScenario(kFolder, name, condition)));
    }
    EXPECT_EQ(hashes.size(), 6u) << name;
  }
}

TEST(ShippedScenarios, EveryOverlayIsACondition) {
  std::set<std::string> expected;
  for (const char* condition : kConditions) {
    if (std::string(condition) == "nominal") continue;
    expected.insert(std::string("medium_") + condition);
    expected.insert(std::string("hard_") + condition);
  }
  const auto names = Names(kFolder + "/conditions");
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), expected);
}

TEST(ShippedScenarios, MediumIsTheStructsDefault) {
  EXPECT_EQ(ToYaml(LoadNamedScenario(kFolder, "medium")), ToYaml(Scenario{}));
}

TEST(ShippedScenarios, HardDiffersFromMediumInNameAndStageOnly) {
  for (const std::string suffix : {"", "_release"}) {
    Scenario hard = LoadNamedScenario(kFolder, "hard" + suffix);
    EXPECT_EQ(hard.world.reset.stage, dynamics::ResetStage::kHard);
    hard.world.reset.stage = dynamics::ResetStage::kMedium;
    hard.run.name = "medium" + suffix;
    EXPECT_EQ(ToYaml(hard), ToYaml(LoadNamedScenario(kFolder, "medium" + suffix)));
  }
}

TEST(ShippedScenarios, ReleaseProfileIsTheReleasesSimulator) {
  const Scenario s = LoadNamedScenario(kFolder, "medium_release");
  EXPECT_EQ(s.mode, InformationMode::kTruth);
  EXPECT_EQ(s.world.vehicle.added_mass_coriolis, dynamics::AddedMassCoriolis::kOff);
  EXPECT_TRUE(s.world.vehicle.reversed_coriolis);
  EXPECT_FALSE(s.world.vehicle.restoring);
  EXPECT_EQ(s.world.vehicle.integrator, dynamics::Integrator::kSemiImplicit);
  EXPECT_TRUE(s.world.vehicle.float32_tau);
  EXPECT_TRUE(s.world.vehicle.clip_velocity);
  EXPECT_EQ(s.reward.kind, task::RewardKind::kRelease);
  EXPECT_EQ(s.agent.observation.order, agent::NeighbourOrder::kIndex);
  EXPECT_EQ(s.channel.model, "range");
  EXPECT_EQ(s.agent.observation_size(), 74);
}

/// The numbers of Tables S7-S8 as the release has them.
TEST(StressConditions, HaveTheReleasesNumbers) {
  const auto speed = [](const Scenario& s) {
    return s.world.reset.stages[static_cast<std::size_t>(s.world.reset.stage)].target_speed_mps;
  };
  for (const std::string suffix : {"", "_release"}) {
    const std::string medium = "medium" + suffix, hard = "hard" + suffix;
    const auto load = [](const std::string& name, const std::string& condition) {
      return LoadNamedScenario(kFolder, name, condition);
    };
    for (const char* condition : {"fast_target", "combined_stress"}) {
      EXPECT_EQ(speed(load(medium, condition)).lo, 0.008);
      EXPECT_EQ(speed(load(medium, condition)).hi, 0.014);
      EXPECT_EQ(speed(load(hard, condition)).lo, 0.014);
      EXPECT_EQ(speed(load(hard, condition)).hi, 0.020);
    }
    for (const char* condition : {"far_initialization", "combined_stress"}) {
      EXPECT_EQ(load(medium, condition).world.reset.stage, dynamics::ResetStage::kHard);
      EXPECT_EQ(load(medium, condition).world.reset.min_separation_m, 0.10);
      EXPECT_EQ(load(hard, condition).world.reset.min_separation_m, 0.14);
    }
    EXPECT_EQ(load(medium, "fast_target").world.reset.stage, dynamics::ResetStage::kMedium);
    for (const std::string& name : {medium, hard}) {
      for (const char* condition :
           {"limited_sensing", "degraded_communication", "combined_stress"}) {
        EXPECT_EQ(load(name, condition).world.sensing.range_m, 0.30);
      }
      EXPECT_EQ(load(name, "degraded_communication").reward.weights.communication, 0.0);
      EXPECT_EQ(load(name, "combined_stress").reward.weights.communication, 0.01);
    }
  }
}

TEST(StressConditions, DegradedCommunicationDegradesEveryAspectOfALink) {
  for (const char* name : {"medium", "hard"}) {
    const acoustics::ChannelConfig good = LoadNamedScenario(kFolder, name).channel;
    for (const char* condition : {"degraded_communication", "combined_stress"}) {
      const acoustics::ChannelConfig bad = LoadNamedScenario(kFolder, name, condition).channel;
      EXPECT_GT(bad.extended.loss_probability, good.extended.loss_probability);
      EXPECT_LT(bad.extended.loss_distance_m, good.extended.loss_distance_m);
      EXPECT_GT(bad.extended.attenuation_per_m, good.extended.attenuation_per_m);
      EXPECT_GT(bad.periodic.transmit_period_s, good.periodic.transmit_period_s);
    }
  }
}

TEST(NamedScenario, ConditionFollowsTheStageOfTheFileAndOverridesComeLast) {
  const Scenario s = LoadNamedScenario(kFolder, "medium", "fast_target", {"reset.stage=hard"});
  EXPECT_EQ(s.world.reset.stage, dynamics::ResetStage::kHard);
  EXPECT_EQ(s.world.reset.stages[2].target_speed_mps.hi, 0.014);
  const std::string path = kFolder + "/medium.yaml";
  EXPECT_EQ(ToYaml(LoadNamedScenario("/none", path)), ToYaml(Scenario{}));
  const std::string overlay = kFolder + "/conditions/hard_fast_target.yaml";
  EXPECT_EQ(LoadNamedScenario(kFolder, "medium", overlay).world.reset.stages[1].target_speed_mps.hi,
            0.020);
}

TEST(NamedScenario, ConditionsOfAFileComeBeforeThoseOfItsStage) {
  EXPECT_EQ(LoadNamedScenario(kFolder, "field", "fast_target").world.target.max_speed_mps, 1.3);
  EXPECT_EQ(LoadNamedScenario(kFolder, "field8", "fast_target").world.target.max_speed_mps, 1.3);
  std::set<std::string> hashes{ScenarioHash(LoadNamedScenario(kFolder, "field"))};
  const auto names = Names(kFolder + "/conditions/field");
  for (const std::string& name : names) {
    hashes.insert(ScenarioHash(LoadNamedScenario(kFolder, "field", name)));
  }
  EXPECT_EQ(hashes.size(), names.size() + 1);
  try {
    LoadNamedScenario(kFolder, "field", "storm");
    ADD_FAILURE();
  } catch (const UserError& e) {
    EXPECT_NE(std::string(e.what()).find("strong_current"), std::string::npos) << e.what();
  }
}

TEST(NamedScenario, UnknownNamesListWhatThereIs) {
  const auto error = [](const std::string& scenario, const std::string& condition) {
    try {
      LoadNamedScenario(kFolder, scenario, condition);
    } catch (const UserError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(error("mediun", "nominal").find("medium, medium_release"), std::string::npos);
  EXPECT_EQ(
      error("medium", "storm"),
      "condition 'storm': the scenario 'medium' has no condition of this name; it has nominal, "
      "combined_stress, degraded_communication, far_initialization, fast_target, "
      "limited_sensing");
  // The scenario's own conditions and those of its bases and its stage, each once.
  const std::string many = error("many8", "storm");
  for (const char* name : {"combined_stress", "unlabelled", "strong_current"}) {
    const std::size_t first = many.find(name);
    EXPECT_NE(first, std::string::npos) << many;
    EXPECT_EQ(many.find(name, first + 1), std::string::npos) << many;
  }
}

TEST(ScenarioFolder, IsFoundByVariableAndOnThePackagePath) {
  setenv("STG_SCENARIOS", kFolder.c_str(), 1);
  EXPECT_EQ(config::ScenarioFolder(), kFolder);
  setenv("STG_SCENARIOS", "/does/not/exist", 1);
  EXPECT_THROW(config::ScenarioFolder(), UserError);
  unsetenv("STG_SCENARIOS");
  const fs::path source = fs::canonical(kFolder).parent_path().parent_path();
  for (const fs::path& entry : {source / "stg_bringup", source, source.parent_path()}) {
    setenv("ROS_PACKAGE_PATH", ("/does/not/exist::" + entry.string()).c_str(), 1);
    EXPECT_TRUE(fs::equivalent(config::ScenarioFolder(), kFolder)) << entry;
  }
  unsetenv("ROS_PACKAGE_PATH");
}

/// The headers that hold the sections of a scenario.
const char* const kSections[] = {
    "auv_common/include/auv_common/config/run_config",
    "auv_dynamics/include/auv_dynamics/autopilot/autopilot_config",
    "auv_dynamics/include/auv_dynamics/vehicle/kinematic_config",
    "auv_dynamics/include/auv_dynamics/vehicle/torpedo_config",
    "auv_dynamics/include/auv_dynamics/vehicle/vehicle_config",
    "auv_dynamics/include/auv_dynamics/world/surroundings_config",
    "auv_dynamics/include/auv_dynamics/world/reset_config",
    "auv_dynamics/include/auv_dynamics/terrain/sea_config",
    "auv_dynamics/include/auv_dynamics/world/world_config",
    "auv_dynamics/include/auv_dynamics/sensing/sensing_config",
    "auv_dynamics/include/auv_dynamics/targets/target_config",
    "auv_dynamics/include/auv_dynamics/control/control_config",
    "acoustic_channel/include/acoustic_channel/access/contention_config",
    "acoustic_channel/include/acoustic_channel/access/periodic_config",
    "acoustic_channel/include/acoustic_channel/access/slots_config",
    "acoustic_channel/include/acoustic_channel/channel_config",
    "acoustic_channel/include/acoustic_channel/models/extended_config",
    "acoustic_channel/include/acoustic_channel/network/physical_config",
    "acoustic_channel/include/acoustic_channel/models/range_config",
    "acoustic_channel/include/acoustic_channel/modem/modem_config",
    "acoustic_channel/include/acoustic_channel/propagation/propagation_config",
    "acoustic_channel/include/acoustic_channel/water/water_config",
    "stg_agent/include/stg_agent/agent_config",
    "stg_agent/include/stg_agent/graph/observation_config",
    "stg_agent/include/stg_agent/estimation/track_config",
    "stg_env/include/stg_env/task/judge_config",
    "stg_env/include/stg_env/task/reward_config",
    "stg_env/include/stg_env/scenario/scenario",
};

/// Finds the members of the structs in the text of these headers.
TEST(ScenarioKeys, CoverEveryMemberOfTheStruct) {
  std::set<std::string> keys, optional;
  Scenario scenario;
  for (const config::Field& field : ScenarioFields(&scenario)) {
    // An optional key may belong to a registered thing. Then it is no member of a struct.
    std::istringstream parts(field.path);
    for (std::string part; std::getline(parts, part, '.');) {
      (field.fallback ? optional : keys).insert(part);
    }
  }
  for (const char* stage : {"easy", "medium", "hard"}) keys.erase(stage);
  std::set<std::string> members;
  std::string text;
  for (const char* section : kSections) {
    const std::string header = ReadText(std::string(STG_SOURCE_FOLDER) + "/" + section + ".hpp");
    ASSERT_FALSE(header.empty()) << section;
    text += header;
  }
  std::istringstream header(text);
  const std::regex section("^  (?:[a-z]+::)?[A-Z][A-Za-z]*(Config|Weights) ([a-z_]+);");
  const std::regex member("([A-Za-z0-9_]+)( = |\\{)");
  for (std::string line; std::getline(header, line);) {
    line = line.substr(0, line.find("//"));
    if (line.find("OptionsByName") != std::string::npos) continue;  // keys of registered things
    std::smatch match;
    if (std::regex_search(line, match, section)) members.insert(match[2]);
    if (line.find("struct") != std::string::npos || line.find("enum") != std::string::npos ||
        line.find("namespace") != std::string::npos || line.find('(') != std::string::npos ||
        line.find("constexpr") != std::string::npos ||
        line.find("const ") != std::string::npos) {  // a parameter of a function
      continue;
    }
    for (std::sregex_iterator it(line.begin(), line.end(), member), end; it != end; ++it) {
      members.insert((*it)[1]);
    }
  }
  for (const char* end : {"lo", "hi"}) members.erase(end);
  // These put sections together or follow from other keys.
  for (const char* part : {"run", "world", "agent", "max_current_mps", "has_range", "has_bearing",
                           "accesses", "transponders", "timekeepers"}) {
    members.erase(part);
  }
  for (const std::string& member : members) {
    EXPECT_TRUE(keys.count(member) > 0 || optional.count(member) > 0) << member << " is no key";
  }
  for (const std::string& key : keys) EXPECT_EQ(members.count(key), 1u) << key << " is no member";
}

/// True for a key that a file may leave out and that belongs to no registered thing, at most to an
/// information mode or a kind of world. True for what agents believe, which is the truth where no
/// file says otherwise.
bool IsOptional(const config::Field& field) {
  if (field.path.rfind("believed.", 0) == 0) return true;
  return field.fallback && std::all_of(field.owners.begin(), field.owners.end(), [](const auto& o) {
           return o->kind == "information mode" || o->kind == "world";
         });
}

TEST(ShippedScenarios, MediumStatesEveryKeyWithItsUnit) {
  Scenario scenario;
  auto fields = ScenarioFields(&scenario);
  fields.erase(std::remove_if(fields.begin(), fields.end(),
                              [](const config::Field& f) { return !f.InFiles() || IsOptional(f); }),
               fields.end());
  std::istringstream file(ReadText(kFolder + "/medium.yaml"));
  std::string comment;
  std::size_t next = 0;
  for (std::string line; std::getline(file, line);) {
    const auto hash = line.find('#');
    const auto start = line.find_first_not_of(' ');
    if (hash != std::string::npos) comment += line.substr(hash);
    if (start == std::string::npos || hash == start || line.back() == ':') continue;
    ASSERT_LT(next, fields.size());
    const config::Field& field = fields[next++];
    const std::string leaf = field.path.substr(field.path.rfind('.') + 1);
    EXPECT_EQ(line.compare(start, leaf.size() + 1, leaf + ":"), 0) << line;
    if (field.unit != "-") {
      EXPECT_NE(comment.find("[" + field.unit + "]"), std::string::npos) << field.path;
    }
    EXPECT_GT(comment.size(), 5u) << field.path;
    comment.clear();
  }
  EXPECT_EQ(next, fields.size()) << "not in the file: "
                                 << fields[std::min(next, fields.size() - 1)].path;
}

/// The tables of docs/scenarios.md, one for each top-level section.
std::string KeyTables() {
  Scenario scenario;
  std::string text, open = "?";
  for (const config::Field& field : ScenarioFields(&scenario)) {
    const auto dot = field.path.find('.');
    const std::string section = dot == std::string::npos ? "" : field.path.substr(0, dot);
    if (section != open) {
      text += "\n### " + (section.empty() ? "Top level" : section) +
              "\n\n| key | meaning | unit, frame | allowed | default |\n|---|---|---|---|---|\n";
    }
    open = section;
    std::string range = std::regex_replace(config::FormatRange(field), std::regex(" \\| "), ", ");
    text += "| `" + field.path + "` | " + field.meaning + " | " + field.unit + " | " + range +
            " | " +
            (std::holds_alternative<config::DifferenceRef>(field.value)
                 ? "that of the key"
                 : "`" + config::FormatValue(field.value) + "`") +
            " |\n";
  }
  return text + "\n";
}

/// STG_UPDATE_REFERENCE=1 in the environment rewrites the tables.
TEST(ScenarioKeys, ReferenceListsEachWithMeaningUnitRangeAndDefault) {
  const std::string begin = "<!-- keys: begin -->\n", end = "<!-- keys: end -->";
  const std::string text = ReadText(kReference);
  const auto from = text.find(begin);
  const auto to = text.find(end);
  ASSERT_TRUE(from != std::string::npos && to != std::string::npos) << kReference;
  const auto start = from + begin.size();
  if (std::getenv("STG_UPDATE_REFERENCE") != nullptr) {
    std::ofstream(kReference) << text.substr(0, start) << KeyTables() << text.substr(to);
    GTEST_SKIP() << "rewritten: " << kReference;
  }
  std::istringstream listed(text.substr(start, to - start)), expected(KeyTables());
  std::string is, should;
  while (std::getline(expected, should)) {
    std::getline(listed, is);
    ASSERT_EQ(is, should) << "run this test once with STG_UPDATE_REFERENCE=1";
  }
  EXPECT_FALSE(std::getline(listed, is)) << is;
}

}  // namespace
}  // namespace stg

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "scenario/scenario_fields.hpp"
#include "stg_env/env/decide.hpp"
#include "stg_env/env/unread_keys.hpp"

/// Nothing that a user sets passes without effect: each key that a scenario accepts changes the
/// flight of a built-in controller, or it stands in a list below, with the reason. Each key that
/// the program `evaluate` accepts with this controller changes its metrics.
namespace stg::env {
namespace {

/// A shipped scenario that flies for a few decisions.
struct Flown {
  std::string scenario, controller;
  int decisions;
  /// Overrides with which rare events, such as contact, happen in these few decisions.
  std::vector<std::string> overrides;
};

/// What is compared: observations, the critic's state, rewards and metrics, as a training reads
/// them, or only the metrics that `evaluate` prints.
enum class Shown { kAll, kMetrics };

/// A hash of what a flight shows.
class Record {
 public:
  template <class T>
  void Add(const std::vector<T>& values) {
    for (const T& value : values) Add(&value, sizeof(value));
  }
  void Add(const task::EpisodeMetrics& metrics) {
    for (const auto& [name, value] : metrics.Items()) Add(&value, sizeof(value));
  }
  std::uint64_t hash() const { return hash_; }

 private:
  void Add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 1099511628211ULL;
  }
  std::uint64_t hash_ = 14695981039346656037ULL;
};

std::uint64_t Fly(const Scenario& s, const Flown& flown, Shown shown) {
  VectorEnvOptions options;
  options.seed = s.run.seed;
  TestEnv env(s, options);
  const agent::Decider decider = agent::MakeDecider(flown.controller, s.model());
  std::vector<double> actions(
      static_cast<std::size_t>(env.envs() * env.agents() * env.action_size()));
  Record record;
  const bool all = shown == Shown::kAll;
  env.Reset();
  do {
    if (all) record.Add(env.memory.observations);
    if (all) record.Add(env.memory.states);
    Decide(decider, env, env.memory.observations.data(), actions.data());
    env.VectorEnv::Step(actions.data(), env.memory.arrays());
    if (all) record.Add(env.memory.rewards);
  } while (!env.truncated());
  if (all) record.Add(env.memory.final_observations);
  if (all) record.Add(env.memory.final_states);
  for (int e = 0; e < env.envs(); ++e) record.Add(env.metrics(e));
  return record.hash();
}

/// Other values of a field, as text. A few of them may be out of range.
std::vector<std::string> OthersOf(const config::Field& field) {
  const auto number = [](double x) { return config::FormatValue(&x); };
  std::vector<std::string> others;
  if (const auto* v = std::get_if<double*>(&field.value)) {
    const double x = **v;
    for (const double y :
         {0.6 * x, 1.7 * x, x + 0.3, 0.01, 0.9, 30.0, -30.0, field.limits.lo, field.limits.hi}) {
      if (y != x && field.limits.Contain(y)) others.push_back(number(y));
    }
  } else if (const auto* v = std::get_if<int*>(&field.value)) {
    for (const int y : {**v + 1, **v - 1, **v * 2}) {
      if (field.limits.Contain(y)) others.push_back(std::to_string(y));
    }
  } else if (const auto* v = std::get_if<std::uint64_t*>(&field.value)) {
    others = {std::to_string(**v + 1)};
  } else if (const auto* v = std::get_if<bool*>(&field.value)) {
    others = {**v ? "false" : "true"};
  } else if (const auto* v = std::get_if<config::EnumRef>(&field.value)) {
    for (std::size_t k = 0; k < v->names.size(); ++k) {
      if (static_cast<int>(k) != v->get()) others.push_back('"' + v->names[k] + '"');
    }
  } else if (const auto* v = std::get_if<config::NumbersRef>(&field.value)) {
    for (const auto& [factor, more] : {std::pair{0.6, 0.0}, {1.7, 0.0}, {1.0, 0.3}, {1.0, 0.01}}) {
      std::vector<double> y;
      for (int k = 0; k < v->size; ++k) y.push_back(factor * v->data[k] + more);
      others.push_back(config::FormatValue(config::NumbersRef{y.data(), v->size}));
    }
  } else if (const auto* v = std::get_if<config::Interval*>(&field.value)) {
    for (const auto& [factor, more] : {std::pair{0.6, 0.0}, {1.7, 0.0}, {1.0, 0.3}}) {
      config::Interval y{factor * (*v)->lo + more, factor * (*v)->hi + more};
      others.push_back(config::FormatValue(&y));
    }
  } else if (const auto* v = std::get_if<config::RowsRef>(&field.value)) {
    // Also a time and an index, or a place in the water and a size.
    std::string row;
    for (const char* x : {"1.0", "2.0", "-40.0", "30.0", "20.0"}) {
      if (static_cast<int>(std::count(row.begin(), row.end(), ',')) + 1 > v->columns) break;
      row += (row.empty() ? "[[" : ", ") + std::string(x);
    }
    others = {v->rows->empty() ? row + "]]" : "[]"};
  } else if (const auto* v = std::get_if<config::NamesRef>(&field.value)) {
    for (const std::string& name : v->names) others.push_back("[" + name + "]");
  } else if (std::holds_alternative<std::string*>(field.value)) {
    others = {"other"};
  } else if (const auto* v = std::get_if<config::DifferenceRef>(&field.value)) {
    others = OthersOf(*v->of);
  }
  return others;
}

/// What changing a key does.
enum class Effect { kNone, kSome, kUntried };

Effect EffectOf(const std::string& path, const Scenario& s, const Flown& flown, Shown shown,
                std::uint64_t unchanged) {
  Scenario original = s;
  config::Table table;
  Describe(&original, &table);
  int tried = 0;
  const std::string own = config::FormatValue(table.Find(path)->value);
  for (const std::string& value : OthersOf(*table.Find(path))) {
    if (value == own) continue;  // e.g. 1.7 times zero
    Scenario changed = s;
    const std::vector<std::string> overrides = {path + "=" + value};
    try {
      config::Override(&changed, overrides);
      changed.ValidateOrThrow();
      if (shown == Shown::kMetrics) {
        RefuseKeysOfTraining(overrides, "evaluate");
        RefuseUnread(agent::MakeDecider(flown.controller, s.model()),
                     {changed.model(), changed.mode, changed.reward.kind}, overrides);
      }
      if (Fly(changed, flown, shown) != unchanged) return Effect::kSome;
      ++tried;
    } catch (const UserError&) {
      continue;  // not allowed, contradicts another key, or this controller does not read it
    }
  }
  return tried == 0 ? Effect::kUntried : Effect::kNone;
}

/// Keys without effect on such a flight, and the reason. A key of a section stands for all of them.
struct Exception {
  std::string key, reason;
};

const std::vector<Exception> kExceptions = {
    {"name", "It is a label of the results."},
    {"vehicle.profile", "It is a label of the vehicle."},
    {"control.action_scale", "Only a training reads it. A policy file contains its own."},
    {"track.search_cell_m", "Only the searching laws and policies read the search map."},
    {"believed.sensing.detection_probability", "Only the search map reads it."},
    {"task.assignment", "Between walls there is one target, so there is nothing to choose."},
    {"channel.slots.guard_s", "It only decides whether a packet fits into a slot."},
    {"channel.physical.modem.packet_bytes", "It only decides whether a packet fits into a slot."},
    {"believed.channel.physical.modem.clock_drift_std_ppm",
     "With known clocks, it only decides whether they are exact enough."},
    {"track.measurements.observers", "With perfect navigation, observers make no errors."},
    {"reset.curriculum", "Only a training chooses stages by it."},
    {"reset.start_half_extent_m",
     "Starts beyond it are drawn again, but these do not begin there."},
    {"sea.latitude_deg", "It is the place of the world's origin, for GPS and maps."},
    {"sea.longitude_deg", "It is the place of the world's origin, for GPS and maps."},
    {"believed.sea.bottom_m", "Only learned policies read it."},
    {"believed.sea.cylinders", "An obstacle of the chart matters only near an AUV."},
    {"target.max_speed_mps", "With a constant velocity, the reset stage states the speeds."},
    {"target.max_turn_rate_radps", "The first turn comes after these flights."},
    {"vehicle.kinematic.min_speed_mps", "Laws command more than it."},
    {"sensing.period_s", "A decision of utracking takes longer than its looks."},
    {"navigation.dead_reckoning.gps_std_m", "No AUV comes to the surface."},
    {"navigation.dead_reckoning.current_std_mps", "The log measures against the bottom."},
};

bool Inside(const std::string& path, const std::string& key) {
  return path == key || path.rfind(key + ".", 0) == 0;
}

bool Excepted(const std::string& path) {
  const std::string believed = "believed.";
  const std::string of = path.rfind(believed, 0) == 0 ? path.substr(believed.size()) : path;
  return std::any_of(kExceptions.begin(), kExceptions.end(),
                     [&](const Exception& e) { return Inside(path, e.key) || of == e.key; });
}

/// The keys that a scenario accepts, although they change nothing in any of these flights of it.
std::vector<std::string> KeysWithoutEffect(const std::vector<Flown>& flights, Shown shown) {
  std::vector<std::string> left;
  for (const Flown& flown : flights) {
    Scenario s = Short(Shipped(flown.scenario, "nominal", flown.overrides), flown.decisions);
    s.run.time.tail_steps = flown.decisions / 2;
    const std::uint64_t unchanged = Fly(s, flown, shown);
    if (&flown == &flights.front()) {
      for (const config::Field& field : ScenarioFields(&s)) {
        if (field.Unchosen() == nullptr && !Excepted(field.path)) left.push_back(field.path);
      }
    }
    left.erase(std::remove_if(left.begin(), left.end(),
                              [&](const std::string& key) {
                                return EffectOf(key, s, flown, shown, unchanged) != Effect::kNone;
                              }),
               left.end());
  }
  return left;
}

std::string Lines(const std::vector<std::string>& keys) {
  std::string text;
  for (const std::string& key : keys) text += "\n  " + key;
  return text;
}

void ExpectThatEveryKeyMatters(const std::vector<Flown>& flights) {
  const auto left = KeysWithoutEffect(flights, Shown::kAll);
  EXPECT_TRUE(left.empty()) << flights.front().scenario
                            << " accepts these keys, but they have no effect:" << Lines(left);
}

/// The same for the metrics of each of two controllers alone.
/// @param rare keys of events that do not happen in these flights
void ExpectThatEveryKeyMattersToLaws(std::vector<Flown> flights,
                                     const std::vector<std::string>& rare) {
  for (const char* law : {"pursuit", "encircle"}) {
    for (Flown& flown : flights) flown.controller = law;
    auto left = KeysWithoutEffect(flights, Shown::kMetrics);
    left.erase(std::remove_if(left.begin(), left.end(),
                              [&](const std::string& key) {
                                return std::find(rare.begin(), rare.end(), key) != rare.end();
                              }),
               left.end());
    EXPECT_TRUE(left.empty()) << "evaluate accepts these keys of " << flights.front().scenario
                              << " with " << law << ", but they have no effect:" << Lines(left);
  }
}

/// Far from the target, near the walls, and near each other.
const std::vector<std::string> kFar = {"reset.stages.medium.auv_distance_m=[0.6, 0.9]",
                                       "reset.stages.medium.target_radius_m=[0.7, 0.9]",
                                       "reset.min_separation_m=0.02"};

/// Pushed and turned so strongly that speeds and rates reach their limits, and AUVs the walls.
const std::vector<std::string> kRough = {"disturbance.force_std_n=40",
                                         "disturbance.moment_std_nm=4",
                                         "reset.stages.medium.auv_distance_m=[0.6, 0.9]",
                                         "reset.stages.medium.target_radius_m=[0.7, 0.9]"};

/// Modems that lose many packets, in quiet water and in bursts of noise.
const std::vector<std::string> kLossy = {
    "channel.physical.modem.source_level_offset_db=-60", "channel.physical.noise.burst_every_s=20",
    "channel.physical.noise.burst_length_s=20", "task.lost_distance_m=150"};

/// Near the target, each other and the bottom; a target at a small distance counts as lost.
std::vector<std::string> Near(const std::string& depth, const std::string& lost_m) {
  return {"reset.stages.medium.auv_distance_m=[5, 40]", "reset.min_separation_m=6",
          "sea.auv_depth_m=" + depth, "sea.target_depth_m=" + depth,
          "task.lost_distance_m=" + lost_m};
}

/// The flights of a scenario, with the controller that shows most of its keys.
std::vector<Flown> FlightsOf(const std::string& scenario) {
  if (scenario == "utracking") {
    return {{scenario, "encircle", 12, {}},
            {scenario, "encircle", 12, {"task.lost_distance_m=181"}},
            {scenario, "pursuit", 30, Near("[100, 118]", "181")}};
  }
  if (scenario == "field" || scenario == "deep") {
    const bool deep = scenario == "deep";
    return {{scenario, "encircle", deep ? 60 : 40, {}},
            {scenario, "encircle", 80, kLossy},
            {scenario, "pursuit", 60, Near(deep ? "[980, 998]" : "[100, 118]", "121")}};
  }
  return {{scenario, "pursuit", 30, {}},
          {scenario, "pursuit", 150, kFar},
          {scenario, "pursuit", 150, kRough}};
}

class EveryKey : public testing::TestWithParam<const char*> {};

TEST_P(EveryKey, Matters) { ExpectThatEveryKeyMatters(FlightsOf(GetParam())); }

TEST_P(EveryKey, ThatEvaluateTakesMatters) {
  ExpectThatEveryKeyMattersToLaws(
      FlightsOf(GetParam()),
      {"reward.w_too_close", "vehicle.radius_m", "contact.stiffness",
       "channel.physical.water.surface_z_m", "channel.physical.water.depth_m"});
}

INSTANTIATE_TEST_SUITE_P(Of, EveryKey,
                         testing::Values("medium", "medium_release", "field", "utracking", "deep"),
                         [](const auto& info) { return std::string(info.param); });

/// A list of exceptions must not hide keys of tomorrow: each of its keys exists.
TEST(EveryKeyOfTheExceptions, Exists) {
  std::vector<std::string> keys;
  for (const Exception& e : kExceptions) keys.push_back(e.key);
  Scenario scenario;
  const auto fields = ScenarioFields(&scenario);
  for (const std::string& key : keys) {
    EXPECT_TRUE(std::any_of(fields.begin(), fields.end(), [&](const config::Field& f) {
      return Inside(f.path, key);
    })) << key;
  }
}

}  // namespace
}  // namespace stg::env

#include "stg_env/env/trace.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <set>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/regular_file.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::env {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::uintmax_t kLargestConfig = 1U << 20;
constexpr std::uintmax_t kLargestSteps = 1U << 28;

const std::set<std::string> kConfigKeys = {"agents",
                                           "dt",
                                           "action_interface",
                                           "action_smoothing",
                                           "action_max_delta",
                                           "velocity_gain",
                                           "rate_gain",
                                           "attitude_gain",
                                           "reward",
                                           "reward_weights",
                                           "initial_positions",
                                           "target_position",
                                           "target_velocity"};

[[noreturn]] void Fail(const std::string& file, int line, const std::string& what) {
  throw UserError(file + ":" + std::to_string(line) + ": " + what);
}

/// Reads and checks the keys of config.yaml.
class Config {
 public:
  explicit Config(const std::string& file) : file_(file) {
    RequireRegularFile(file, kLargestConfig);
    try {
      root_ = YAML::LoadFile(file);
    } catch (const YAML::Exception& e) {
      Fail(file, e.mark.line + 1, e.msg);
    }
    if (!root_.IsMap()) Fail(file, 1, "expected a map of keys");
    for (const auto& entry : root_) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
      if (!kConfigKeys.count(key))
        Fail(file, entry.first.Mark().line + 1, "unknown key '" + key + "'");
    }
  }
  YAML::Node Get(const std::string& key) {
    const YAML::Node node = root_[key];
    if (!node) Fail(file_, 1, "missing key '" + key + "'");
    return node;
  }
  double Number(const std::string& key) { return Number(Get(key), key); }
  double Number(const YAML::Node& node, const std::string& key) {
    try {
      const double value = node.as<double>();
      if (std::isfinite(value)) return value;
    } catch (const YAML::Exception&) {
    }
    Fail(file_, node.Mark().line + 1, "key '" + key + "': expected a finite number");
  }
  int Whole(const std::string& key, int lo, int hi) {
    const double value = Number(key);
    if (value >= lo && value <= hi && value == std::floor(value)) return static_cast<int>(value);
    Fail(file_, Get(key).Mark().line + 1,
         "key '" + key + "': expected a whole number from " + std::to_string(lo) + " to " +
             std::to_string(hi));
  }
  std::string Word(const std::string& key) {
    const YAML::Node node = Get(key);
    if (!node.IsScalar()) Fail(file_, node.Mark().line + 1, "key '" + key + "': expected a word");
    return node.Scalar();
  }
  Vec3<double> Vector(const YAML::Node& node, const std::string& key) {
    if (!node.IsSequence() || node.size() != 3) {
      Fail(file_, node.Mark().line + 1, "key '" + key + "': expected three numbers");
    }
    return {Number(node[0], key), Number(node[1], key), Number(node[2], key)};
  }
  void Choice(const std::string& key, const std::map<std::string, std::function<void()>>& options) {
    const auto found = options.find(Word(key));
    if (found != options.end()) return found->second();
    std::string names;
    for (const auto& o : options) names += (names.empty() ? "" : ", ") + o.first;
    Fail(file_, Get(key).Mark().line + 1, "key '" + key + "': expected one of " + names);
  }

 private:
  std::string file_;
  YAML::Node root_;
};

std::vector<std::string> Split(const std::string& line) {
  std::vector<std::string> cells;
  std::string cell;
  std::istringstream in(line);
  while (std::getline(in, cell, ',')) cells.push_back(cell);
  if (!line.empty() && line.back() == ',') cells.emplace_back();
  return cells;
}

void ReadSteps(const std::string& file, Trace* trace) {
  std::ifstream in = OpenText(file, kLargestSteps);
  std::string line;
  int number = 0;
  while (std::getline(in, line)) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::vector<std::string> cells = Split(line);
    if (number == 1) {
      trace->columns = cells;
      continue;
    }
    if (cells.size() != trace->columns.size()) {
      Fail(file, number,
           "expected " + std::to_string(trace->columns.size()) + " cells, found " +
               std::to_string(cells.size()));
    }
    std::vector<double> row;
    for (size_t c = 0; c < cells.size(); ++c) {
      const bool is_action = trace->columns[c].size() == 2 && trace->columns[c][0] == 'a';
      if (cells[c].empty() && !is_action) {
        row.push_back(kNone);
        continue;
      }
      char* end = nullptr;
      row.push_back(std::strtod(cells[c].c_str(), &end));
      if (cells[c].empty() || *end != '\0' || !std::isfinite(row.back())) {
        Fail(file, number,
             "column '" + trace->columns[c] + "': '" + cells[c] + "' is not a number");
      }
    }
    trace->rows.push_back(std::move(row));
  }
  const auto n = static_cast<size_t>(trace->scenario.run.agents);
  if (trace->rows.empty() || trace->rows.size() % n != 0) {
    Fail(file, number, "expected a whole number of steps of " + std::to_string(n) + " rows");
  }
}

/// This environment's value of every known column, by name.
using Columns = std::map<std::string, std::pair<std::string, std::function<double(int)>>>;

Columns OurColumns(const VectorEnv& env, const EnvMemory& memory,
                   const dynamics::VehicleConfig& vehicle) {
  Columns c;
  const auto add = [&](const std::string& group, const std::string& name,
                       std::function<double(int)> f) {
    c[name] = {group, std::move(f)};
  };
  const auto vec = [&](const std::string& group, const std::vector<std::string>& names,
                       const std::function<Vec3<double>(int)>& f) {
    add(group, names[0], [f](int i) { return f(i).x; });
    add(group, names[1], [f](int i) { return f(i).y; });
    add(group, names[2], [f](int i) { return f(i).z; });
  };
  const auto v = [&env](int i) { return env.vehicle(0, i); };
  vec("state", {"px", "py", "pz"}, [v](int i) { return v(i).p_WB; });
  vec("state", {"vx", "vy", "vz"}, [v](int i) { return v(i).v_WB; });
  vec("state", {"u", "v", "w"}, [v](int i) { return v(i).v_WB_B; });
  vec("state", {"p", "q", "r"}, [v](int i) { return v(i).w_WB_B; });
  vec("angle", {"phi", "theta", "psi"}, [v](int i) { return v(i).rpy; });
  const auto target = [&env](int i) { return env.target(0, env.followed(0, i)); };
  vec("target", {"tpx", "tpy", "tpz"}, [target](int i) { return target(i).p_WT; });
  vec("target", {"tvx", "tvy", "tvz"}, [target](int i) { return target(i).v_WT; });
  for (int k = 0; k < 6; ++k) {
    const double max = vehicle.max_tau[static_cast<size_t>(k)];
    add("tau", "tau" + std::to_string(k),
        [&env, k, max](int i) { return env.knowledge(0, i).tau[k] * max; });
  }
  for (int k = 0; k < env.observation_size(); ++k) {
    add("observation", "obs" + std::to_string(k),
        [&memory, k](int i) { return static_cast<double>(memory.observation(0, i)[k]); });
  }
  const auto term = [&env](int i) { return env.terms(0, i); };
  add("reward", "reward", [term](int i) { return term(i).total; });
  add("reward", "r_track", [term](int i) { return term(i).track; });
  add("reward", "r_obs", [term](int i) { return term(i).observation; });
  add("reward", "r_coord", [term](int i) { return term(i).coordination; });
  add("reward", "r_comm", [term](int i) { return term(i).communication; });
  add("reward", "r_sem", [term](int i) { return term(i).semantic; });
  add("reward", "cost", [term](int i) { return term(i).cost; });
  add("state", "distance", [&env](int i) { return env.tracking(0, i).distance; });
  add("state", "lost", [&env](int i) { return env.tracking(0, i).lost; });
  return c;
}

}  // namespace

Trace LoadTrace(const std::string& folder, const Scenario& base) {
  Trace t;
  t.folder = folder;
  t.scenario = base;
  Scenario& s = t.scenario;
  const std::string file = folder + "/config.yaml";
  Config c(file);
  s.run.agents = c.Whole("agents", 1, 255);
  s.run.time.dt_s = c.Number("dt");
  c.Choice(
      "action_interface",
      {{"velocity3", [&] { s.world.control.interface = dynamics::ActionInterface::kVelocity3; }},
       {"tau6", [&] { s.world.control.interface = dynamics::ActionInterface::kTau6; }}});
  s.world.control.smoothing = c.Number("action_smoothing");
  s.world.control.max_delta = c.Number("action_max_delta");
  s.world.control.velocity_gain = c.Number("velocity_gain");
  s.world.control.attitude_gain = c.Number("attitude_gain");
  s.world.control.rate_gain = c.Number("rate_gain");
  c.Choice("reward", {{"stg", [&] { s.reward.kind = task::RewardKind::kRelease; }},
                      {"raw", [&] { s.reward.kind = task::RewardKind::kReleaseRaw; }}});
  const YAML::Node weights = c.Get("reward_weights");
  const auto weight = [&](const char* key) { return c.Number(weights[key], key); };
  for (const char* key :
       {"tracking", "observation", "coordination", "communication", "semantic", "control_cost"}) {
    if (!weights.IsMap() || !weights[key]) {
      Fail(file, weights.Mark().line + 1, std::string("missing key 'reward_weights.") + key + "'");
    }
  }
  s.reward.weights = {weight("tracking"),
                      weight("observation"),
                      weight("coordination"),
                      weight("communication"),
                      weight("semantic"),
                      weight("control_cost"),
                      0.0};
  const YAML::Node positions = c.Get("initial_positions");
  if (!positions.IsSequence() || static_cast<int>(positions.size()) != s.run.agents) {
    Fail(file, positions.Mark().line + 1,
         "key 'initial_positions': expected one position per agent");
  }
  for (const auto& p : positions) t.p_WB.push_back(c.Vector(p, "initial_positions"));
  t.p_WT.push_back(c.Vector(c.Get("target_position"), "target_position"));
  t.v_WT.push_back(c.Vector(c.Get("target_velocity"), "target_velocity"));
  try {
    s.ValidateOrThrow();
  } catch (const UserError& e) {
    throw UserError(file + ": " + e.what());
  }
  ReadSteps(folder + "/steps.csv", &t);
  s.run.time.episode_steps = static_cast<int>(t.rows.size()) / s.run.agents + 1;
  s.run.time.tail_steps = 1;
  return t;
}

TraceError ReplayTrace(const Trace& trace, double tolerance) {
  const Scenario& s = trace.scenario;
  VectorEnvOptions options;
  options.envs = 1;
  VectorEnv env(s, options);
  EnvMemory memory = env.MakeMemory();
  env.Place(trace.p_WB, trace.p_WT, trace.v_WT, memory.arrays());
  const Columns ours = OurColumns(env, memory, s.world.vehicle);
  const int n = s.run.agents, size = s.world.control.action_size();
  std::map<std::string, size_t> column;
  for (size_t c = 0; c < trace.columns.size(); ++c) column[trace.columns[c]] = c;
  for (int k = 0; k < size; ++k) {
    if (!column.count("a" + std::to_string(k))) {
      throw UserError(trace.folder + "/steps.csv:1: missing column a" + std::to_string(k));
    }
  }
  TraceError result;
  std::vector<double> actions(static_cast<size_t>(n * size));
  const int steps = static_cast<int>(trace.rows.size()) / n;
  result.steps = steps;
  for (int step = 0; step < steps; ++step) {
    const auto row = [&](int i) -> const std::vector<double>& {
      return trace.rows[static_cast<size_t>(step * n + i)];
    };
    if (step > 0) {
      for (int i = 0; i < n; ++i) {
        for (int k = 0; k < size; ++k) {
          actions[static_cast<size_t>(i * size + k)] = row(i)[column["a" + std::to_string(k)]];
        }
      }
      env.Step(actions.data(), memory.arrays());
    }
    for (const auto& [name, source] : ours) {
      const auto found = column.find(name);
      if (found == column.end()) continue;
      for (int i = 0; i < n; ++i) {
        const double expected = row(i)[found->second];
        if (std::isnan(expected)) continue;
        double error = std::abs(source.second(i) - expected);
        // Angles near +-pi may differ by a full turn.
        if (source.first == "angle") error = std::min(error, std::abs(error - 2.0 * kPi));
        double& worst = result.by_group[source.first];
        worst = std::max(worst, error);
        result.by_column[name] = std::max(result.by_column[name], error);
        if (result.first_bad_step < 0 && !(error <= tolerance)) {
          result.first_bad_step = step;
          result.first_bad_column = name;
        }
        if (error > result.max_abs_error || std::isnan(error)) {
          result.max_abs_error =
              std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
          result.worst_step = step;
          result.worst_agent = i;
          result.worst_column = name;
        }
      }
    }
  }
  for (const char* group : {"state", "observation", "reward"}) {
    if (!result.by_group.count(group)) {
      throw UserError(trace.folder + "/steps.csv:1: no column of the " + group + " to compare");
    }
  }
  return result;
}

}  // namespace stg::env

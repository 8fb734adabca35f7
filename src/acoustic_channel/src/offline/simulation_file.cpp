#include "acoustic_channel/offline/simulation_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/models/propagation_model.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

using config::YamlTree;

constexpr std::size_t kMaxNodes = 1000;
/// Nearly the number that fits into the largest file, because times of packets are lists.
constexpr int kMaxValues = 300000;
constexpr double kLongestS = 1e8;

/// The keys of one map of the file. Each follows the usual rules of configurations.
class Reader {
 public:
  /// @param prefix prefix of the keys in messages, with a point at its end; or empty
  Reader(const std::string& file, const YamlTree& map, const std::string& prefix)
      : file_(file), map_(map), prefix_(prefix) {
    if (map.kind != YamlTree::Kind::kMap) {
      throw UserError(file + ":" + std::to_string(map.line) + ": " +
                      (prefix.empty() ? "" : prefix.substr(0, prefix.size() - 1) + ": ") +
                      "expected a map of keys");
    }
    if (!prefix.empty()) table_.Section(prefix.substr(0, prefix.size() - 1));
  }

  config::Table* table() { return &table_; }

  const YamlTree::Entry* Find(const std::string& key) const {
    for (const YamlTree::Entry& entry : map_.entries) {
      if (entry.key == key) return &entry;
    }
    return nullptr;
  }
  bool Has(const std::string& key) const { return Find(key) != nullptr; }
  void Require(const std::string& key) const {
    if (!Has(key)) Fail(map_.line, key, "missing key");
  }
  [[noreturn]] void Fail(int line, const std::string& key, const std::string& message) const {
    throw UserError(file_ + ":" + std::to_string(line) + ": " + prefix_ + key + ": " + message);
  }
  [[noreturn]] void Fail(const std::string& key, const std::string& message) const {
    const YamlTree::Entry* entry = Find(key);
    Fail(entry != nullptr ? entry->line : map_.line, key, message);
  }
  void Refuse(const std::vector<std::string>& keys, const std::string& why) const {
    for (const std::string& key : keys) {
      if (Has(key)) Fail(key, why);
    }
  }

  /// Reads all keys into the members that the table points to, except the ones in `by_hand`, which
  /// the caller reads.
  const config::Loader& Read(const std::vector<std::string>& by_hand) {
    YamlTree rest = map_;
    rest.entries.clear();
    for (const YamlTree::Entry& entry : map_.entries) {
      if (std::find(by_hand.begin(), by_hand.end(), entry.key) == by_hand.end()) {
        rest.entries.push_back(entry);
      }
    }
    loader_.emplace(table_, config::Scope::kWhole);
    loader_->ApplyPart(rest, prefix_, file_);
    loader_->RefuseUnread();
    return *loader_;
  }

  /// The elements of a list; there is at least one.
  const std::vector<YamlTree>& List(const std::string& key) const {
    Require(key);
    const YamlTree::Entry& entry = *Find(key);
    if (entry.value.kind != YamlTree::Kind::kSequence || entry.value.items.empty()) {
      Fail(key, "expected a list that is not empty");
    }
    return entry.value.items;
  }

 private:
  const std::string& file_;
  const YamlTree& map_;
  std::string prefix_;
  config::Table table_;
  std::optional<config::Loader> loader_;  ///< made when the table is complete
};

/// Removes keys of a scenario, because this file does not have them.
config::Violation InThisFile(config::Violation violation, const config::Table& table) {
  auto& keys = violation.keys;
  const auto unknown = [&](const std::string& key) { return table.Find(key) == nullptr; };
  keys.erase(std::remove_if(keys.begin(), keys.end(), unknown), keys.end());
  if (keys.empty()) keys = {"step_s"};
  return violation;
}

std::string Item(const std::string& list, std::size_t index) {
  return list + "[" + std::to_string(index) + "].";
}

SimulatedNode ReadNode(const std::string& file, const YamlTree& map, std::size_t index) {
  Reader reader(file, map, Item("nodes", index));
  SimulatedNode node;
  std::array<double, 3> p{}, v{};
  config::Table* t = reader.table();
  t->Add("id", &node.id, config::Within(0, 1e9), "-", "");
  t->Add("position_m", config::Numbers(&p), config::Within(-1e7, 1e7), "m", "");
  t->Add("velocity_mps", config::Numbers(&v), config::Within(-100.0, 100.0), "m/s", "");
  t->Add("joins_s", &node.joins_s, config::NonNegative(kLongestS), "s", "");
  t->Add("leaves_s", &node.leaves_s, config::Positive(kLongestS), "s", "");
  reader.Read({"track"});
  reader.Require("id");
  if (const YamlTree::Entry* track = reader.Find("track")) {
    reader.Refuse({"position_m", "velocity_mps"}, "cannot be combined with a track");
    if (track->value.kind != YamlTree::Kind::kScalar || track->value.scalar.empty()) {
      reader.Fail("track", "expected the name of a CSV file");
    }
    const auto folder = std::filesystem::path(file).parent_path();
    const std::string path = (folder / track->value.scalar).string();
    try {
      node.track = Track::Load(path);
      node.track_file = track->value.scalar;
    } catch (const UserError& e) {
      reader.Fail("track", e.what());
    }
  } else {
    reader.Require("position_m");
    node.track = Track::Line({p[0], p[1], p[2]}, {v[0], v[1], v[2]});
  }
  if (reader.Has("leaves_s") && node.leaves_s <= node.joins_s) {
    reader.Fail("leaves_s", "must be later than joins_s");
  }
  return node;
}

std::vector<double> ReadTimes(const Reader& reader) {
  double time = 0.0;
  const config::Field field{"times_s", &time, config::NonNegative(kLongestS), "s", ""};
  std::vector<double> times;
  for (const YamlTree& item : reader.List("times_s")) {
    if (const auto message = config::ParseValue(field, item)) {
      reader.Fail(item.line, "times_s", *message);
    }
    times.push_back(time);
  }
  std::stable_sort(times.begin(), times.end());
  return times;
}

TrafficSpec ReadFlow(const std::string& file, const YamlTree& map, std::size_t index,
                     const std::map<int, int>& index_of, std::size_t max_payload,
                     double duration_s) {
  using Kind = TrafficSpec::Kind;
  Reader reader(file, map, Item("traffic", index));
  TrafficSpec flow;
  int source = 0, destination = 0, bytes = 0;
  config::Table* t = reader.table();
  t->Add("source", &source, config::Within(0, 1e9), "-", "");
  t->Add("destination", &destination, config::Within(0, 1e9), "-", "");
  t->Add("kind", config::Enum(&flow.kind, {"poisson", "periodic", "at"}), config::kNone, "-", "");
  t->Add("rate_hz", &flow.rate_hz, config::Within(1e-9, 1e4), "1/s", "");
  t->Add("period_s", &flow.period_s, config::Within(1e-4, kLongestS), "s", "");
  t->Add("offset_s", &flow.offset_s, config::NonNegative(kLongestS), "s", "");
  t->Add("bytes", &bytes, config::Within(1, 1e6), "-", "");
  reader.Read({"times_s"});
  for (const char* key : {"source", "kind", "bytes"}) reader.Require(key);
  const auto node = [&](const std::string& key, int id) {
    const auto found = index_of.find(id);
    if (found == index_of.end()) reader.Fail(key, "no node has the id " + std::to_string(id));
    return found->second;
  };
  flow.source = node("source", source);
  if (reader.Has("destination")) {
    flow.destination = node("destination", destination);
    if (flow.destination == flow.source) reader.Fail("destination", "must differ from the source");
  }
  flow.bytes = static_cast<std::size_t>(bytes);
  if (flow.bytes > max_payload) {
    reader.Fail("bytes",
                "more than the longest packet of this channel, " + std::to_string(max_payload));
  }
  const std::string other = "belongs to another kind of traffic";
  switch (flow.kind) {
    case Kind::kPoisson:
      reader.Require("rate_hz");
      reader.Refuse({"period_s", "offset_s", "times_s"}, other);
      break;
    case Kind::kPeriodic:
      reader.Require("period_s");
      reader.Refuse({"rate_hz", "times_s"}, other);
      if (flow.offset_s >= duration_s) {
        reader.Fail("offset_s", "the first packet is not before the end, duration_s");
      }
      break;
    case Kind::kAt:
      flow.times_s = ReadTimes(reader);
      if (!flow.times_s.empty() && flow.times_s.back() >= duration_s) {
        reader.Fail("times_s", "a time is not before the end, duration_s");
      }
      reader.Refuse({"rate_hz", "period_s", "offset_s"}, other);
      break;
  }
  return flow;
}

/// Refuses nodes with modems that are in the air or in the ground while they take part, because the
/// model covers neither. Between the points of a track the way is straight.
void RequireInWater(const std::string& file, const Reader& reader, const SimulationFile& s) {
  if (!PropagationModels().Make(s.channel.model, s.channel.models, s.channel)->has_modems()) return;
  const WaterConfig& water = s.channel.physical.water;
  const auto& items = reader.List("nodes");
  for (std::size_t i = 0; i < items.size(); ++i) {
    const SimulatedNode& node = s.nodes[i];
    const double end_s = node.leaves_s > 0.0 ? std::min(node.leaves_s, s.duration_s) : s.duration_s;
    for (const double t_s : node.track.Corners(node.joins_s, end_s)) {
      Vec3<double> p_W, v_W;
      node.track.At(t_s, &p_W, &v_W);
      const double depth_m = water.surface_z_m - p_W.z;
      if (depth_m >= 0.0 && depth_m <= water.depth_m) continue;
      const std::string where =
          depth_m < 0.0 ? std::to_string(-depth_m) + " m above the surface"
                        : std::to_string(depth_m) + " m deep, where the water has " +
                              std::to_string(water.depth_m) + " m (channel.physical.water.depth_m)";
      const bool tracked = Reader(file, items[i], Item("nodes", i)).Has("track");
      Reader(file, items[i], Item("nodes", i))
          .Fail(tracked ? "track" : "position_m",
                "at " + std::to_string(t_s) + " s the node is " + where);
    }
  }
}

void ReadNodes(const std::string& file, const Reader& reader, SimulationFile* simulation) {
  const auto& items = reader.List("nodes");
  if (items.size() < 2) reader.Fail("nodes", "a network needs at least two nodes");
  if (items.size() > kMaxNodes) {
    reader.Fail("nodes", "more than " + std::to_string(kMaxNodes) + " nodes");
  }
  std::map<int, std::size_t> seen;
  for (std::size_t i = 0; i < items.size(); ++i) {
    simulation->nodes.push_back(ReadNode(file, items[i], i));
    const int id = simulation->nodes.back().id;
    if (!seen.insert({id, i}).second) {
      reader.Fail(
          items[i].line, Item("nodes", i) + "id",
          std::to_string(id) + " is also the id of nodes[" + std::to_string(seen[id]) + "]");
    }
  }
  RequireInWater(file, reader, *simulation);
  std::sort(simulation->nodes.begin(), simulation->nodes.end(),
            [](const SimulatedNode& a, const SimulatedNode& b) { return a.id < b.id; });
}

/// Lets keys of the channel belong to what only swarms of AUVs have.
void OwnByOthers(const ChannelConfig* channel, config::Table* t) {
  OwnByScenarios(channel, false, t);
  const auto own = [t](const std::string& key, const char* kind, std::vector<std::string> names) {
    t->Own("channel." + key, {kind, std::move(names), "simulate has none",
                              [] { return std::vector<std::string>(); }});
  };
  for (const char* key : {"clock_offset_std_s", "clock_drift_std_ppm", "timing_std_s",
                          "late_probability", "late_max_s"}) {
    own(std::string("physical.modem.") + key, "ranging", {"one_way", "ping"});
  }
  for (const char* key : {"range.freshness_s", "extended.attenuation_per_m", "extended.freshness_s",
                          "physical.modem.freshness_s"}) {
    own(key, "link quality", {"of agents"});
  }
}

}  // namespace

RunConfig SimulationFile::Run() const {
  RunConfig run;
  run.name = "simulate";
  run.seed = seed;
  run.agents = static_cast<int>(nodes.size());
  run.time.dt_s = step_s;
  run.time.decision_steps = 1;
  return run;
}

SimulationFile LoadSimulation(const std::string& path) {
  const YamlTree root = config::ParseYaml(config::ReadBoundedFile(path), path, true, kMaxValues);
  config::LoadPluginsIn(root, path);
  Reader reader(path, root, "");
  SimulationFile simulation;
  config::Table* t = reader.table();
  t->Add("duration_s", &simulation.duration_s, config::Positive(kLongestS), "s", "");
  t->Add("seed", &simulation.seed, config::kNone, "-", "");
  t->Add("step_s", &simulation.step_s, config::Within(1e-3, 10.0), "s", "");
  Describe(&simulation.channel, t);
  OwnByOthers(&simulation.channel, t);
  const config::Loader& loader = reader.Read({"nodes", "traffic"});
  for (const char* key : {"duration_s", "channel", "nodes", "traffic"}) reader.Require(key);
  ReadNodes(path, reader, &simulation);

  const RunConfig run = simulation.Run();
  if (const auto violation = FindConflict(simulation.channel, run)) {
    loader.Refuse(InThisFile(*violation, *t));
  }
  const std::size_t max_payload = MakeChannel(simulation.channel, run)->max_payload();
  std::map<int, int> index_of;
  for (const SimulatedNode& node : simulation.nodes) {
    index_of.insert({node.id, static_cast<int>(index_of.size())});
  }
  const auto& flows = reader.List("traffic");
  for (std::size_t i = 0; i < flows.size(); ++i) {
    simulation.traffic.push_back(
        ReadFlow(path, flows[i], i, index_of, max_payload, simulation.duration_s));
  }
  return simulation;
}

}  // namespace stg::acoustics

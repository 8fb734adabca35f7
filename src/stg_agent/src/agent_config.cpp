#include "stg_agent/agent_config.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "acoustic_channel/models/propagation_model.hpp"
#include "auv_common/config/value.hpp"
#include "auv_common/names.hpp"
#include "auv_dynamics/navigation/navigation_system.hpp"
#include "stations/auv_pings.hpp"
#include "stg_agent/estimation/target_filter.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

void Describe(TaskConfig* c, config::Table* t) {
  t->Section("task");
  t->Add("desired_distance_m", &c->desired_distance_m, config::NonNegative(1e4), "m",
         "desired distance d* from the target");
  t->Add("lost_distance_m", &c->lost_distance_m, config::Positive(1e5), "m",
         "a target farther away than this counts as lost");
  t->AddOptional("lost_error_m", &c->lost_error_m, "0.0", config::NonNegative(1e5), "m",
                 "in open water a target also counts as lost where the AUV's own estimate is off "
                 "by more than this; 0: no such limit");
  t->AddOptional(
      "assignment", config::Enum(&c->assignment, {"modulo", "free"}), "modulo", config::kNone, "-",
      "target that an AUV follows. modulo: AUV i follows target i modulo their number; free: the "
      "AUV chooses, estimates every target and shares its measurements of all");
  t->Moved("reward.desired_distance_m", "task.desired_distance_m");
  t->Moved("reward.lost_distance_m", "task.lost_distance_m");
}

bool FleetConfig::present(int agent, double time_s) const {
  bool there = true;
  double newest = -1.0;
  const auto take = [&](const std::vector<std::vector<double>>& rows, bool joins) {
    for (const std::vector<double>& row : rows) {
      if (static_cast<int>(row[1]) != agent || row[0] > time_s || row[0] < newest) continue;
      newest = row[0];
      there = joins;
    }
  };
  take(leave, false);
  take(join, true);
  return there;
}

void Describe(FleetConfig* c, config::Table* t) {
  t->Section("fleet");
  t->AddOptional(
      "leave", config::RowsRef{&c->leave, 2}, "[]", config::Within(0.0, 1e9), "s, -",
      "AUVs that leave the swarm: rows of a time from the start of the episode and an AUV's index. "
      "An AUV that has left sends nothing, senses nothing, and is commanded to stand still");
  t->AddOptional("join", config::RowsRef{&c->join, 2}, "[]", config::Within(0.0, 1e9), "s, -",
                 "AUVs that join again after they left: rows of a time and an AUV's index. An AUV "
                 "joins at the place where it is, without any knowledge");
}

namespace {

std::optional<config::Violation> FindConflict(const FleetConfig& c, int agents) {
  for (const auto* rows : {&c.leave, &c.join}) {
    for (const std::vector<double>& row : *rows) {
      if (row[1] >= agents || row[1] != std::floor(row[1])) {
        return config::Violation{{rows == &c.leave ? "fleet.leave" : "fleet.join", "agents"},
                                 "a row must be a time from 0 and the index of an AUV"};
      }
    }
  }
  for (const std::vector<double>& row : c.join) {
    if (c.present(static_cast<int>(row[1]), std::nextafter(row[0], -1.0))) {
      return config::Violation{{"fleet.join", "fleet.leave"},
                               "an AUV can only join after it has left"};
    }
  }
  return {};
}

/// Settings that contradict targets that are chosen freely.
std::optional<config::Violation> FindFreeConflict(const AgentModel& model) {
  if (!model.task.free()) {
    if (model.sensing.labelled) return {};
    return config::Violation{
        {"sensing.labelled", "task.assignment"},
        "an AUV assigns unlabelled detections to its estimates of all targets, which only the "
        "assignment free has"};
  }
  if (model.target.count > kMostFreeTargets) {
    return config::Violation{{"task.assignment", "target.count"},
                             "with the assignment free, a packet can describe at most " +
                                 std::to_string(kMostFreeTargets) + " targets"};
  }
  if (model.track.search_cell_m > 0.0) {
    return config::Violation{
        {"task.assignment", "track.search_cell_m"},
        "the search map is for the assignment modulo only, as it holds one target"};
  }
  if (model.locates()) {
    return config::Violation{
        {"task.assignment", "localization.kind"},
        "packets with ranges have no room for the measurements that the assignment free sends"};
  }
  return {};
}

}  // namespace

void Describe(AgentConfig* c, config::Table* t) {
  Describe(&c->track, t);
  Describe(&c->observation, t);
  Describe(&c->task, t);
  Describe(&c->fleet, t);
  Describe(&c->localization, t);
  Describe(&c->stations, t);
}

void OwnAcrossSections(const dynamics::WorldConfig* world, const acoustics::ChannelConfig* channel,
                       const AgentConfig* agent, config::Table* t) {
  using Names = std::vector<std::string>;
  t->Own("task.lost_error_m", {"world", {"open water"}, "sea.open", [world] {
                                 return Names{world->sea.open ? "open water" : "walls"};
                               }});
  const auto shadows = [world] {
    const dynamics::SeaConfig& sea = world->sea;
    Names names;
    if (sea.open && sea.terrain != "flat") names.emplace_back("terrain");
    if (sea.open && !(sea.spheres.empty() && sea.cylinders.empty()))
      names.emplace_back("obstacles");
    return names;
  };
  t->Own("channel.physical.propagation.shadow_db", {"sea",
                                                    {"terrain", "obstacles"},
                                                    "sea.terrain",
                                                    shadows,
                                                    {"sea.spheres", "sea.cylinders", "sea.open"}});
  // Perfect navigation makes no errors.
  const Names erring = Without(dynamics::NavigationSystems().Names(), {"perfect"});
  for (const char* key : {"observers", "shear_std_mps", "shear_memory_s"}) {
    t->Own(std::string("track.measurements.") + key,
           {"navigation system", erring, "navigation.kind",
            [world] { return Names{world->navigation.kind}; }});
  }
  // Agents use the times of their modems only if they measure ranges with them.
  const auto ranging = [world, agent] {
    Names names;
    if (agent->localization.kind != "uncorrected") {
      names.emplace_back(agent->localization.by == RangesBy::kPing ? "ping" : "one_way");
    }
    if (world->sensing.pings()) names.emplace_back("ping");
    return names;
  };
  // With pings a range is a difference of two times of one clock, so its offset has no effect.
  t->Own("channel.physical.modem.clock_offset_std_s",
         {"ranging", {"one_way"}, "localization.kind", ranging, {"localization.ranges.by"}, true});
  // In slots, AUVs make a packet only when it can leave, and no packet waits.
  const std::string listening = "csma";
  t->Own("channel.physical.modem.queue", {"waiting packets",
                                          {listening, "ping"},
                                          "channel.access",
                                          [channel, ranging] {
                                            Names names{channel->access};
                                            for (const std::string& name : ranging())
                                              names.push_back(name);
                                            return names;
                                          },
                                          {"sensing.ranging", "localization.ranges.by"},
                                          true});
  for (const char* key :
       {"clock_drift_std_ppm", "timing_std_s", "late_probability", "late_max_s"}) {
    t->Own(std::string("channel.physical.modem.") + key,
           {"ranging",
            {"one_way", "ping"},
            "localization.kind",
            ranging,
            {"localization.ranges.by", "sensing.ranging"}});
  }
}

void DescribeBelieved(const AgentConfig* agent, config::Differences* differences,
                      config::Table* t) {
  t->Differ("believed", KeysOfModel(), differences);
  // An agent has no other use for the chance of a detection than what a search finds nothing in.
  t->Own("believed.sensing.detection_probability",
         {"search", {"with a map"}, "track.search_cell_m", [agent] {
            const bool map = agent->track.search_cell_m > 0.0;
            return std::vector<std::string>{map ? "with a map" : "without a map"};
          }});
  // A ping needs no knowledge of the errors of clocks.
  t->Own("believed.channel.physical.modem.clock_drift_std_ppm",
         {"ranging",
          {"one_way"},
          "localization.kind",
          [agent] {
            const bool one_way = agent->localization.by == RangesBy::kOneWay;
            return std::vector<std::string>{one_way ? "one_way" : "ping"};
          },
          {"localization.ranges.by"}});
}

void Describe(AgentScenario* s, config::Table* t) {
  Describe(&s->run, t);
  Describe(&s->world, t);
  Describe(&s->channel, t);
  Describe(&s->agent, t);
  OwnAcrossSections(&s->world, &s->channel, &s->agent, t);
  DescribeBelieved(&s->agent, &s->agent_model, t);
}

std::optional<config::Violation> FindConflict(const AgentScenario& s) {
  if (auto violation = FindConflict(s.run)) return violation;
  if (auto violation = FindConflict(s.world, s.run)) return violation;
  if (auto violation = FindConflict(s.channel, s.run)) return violation;
  if (acoustics::MaxPayload(s.channel, s.run.agents) < kPacketBytes) {
    return config::Violation{
        {"channel.physical.modem.packet_bytes", "channel.physical.modem.profile"},
        "the packet of an agent has " + std::to_string(kPacketBytes) + " bytes"};
  }
  if (auto violation = FindConflict(s.agent.fleet, s.run.agents)) return violation;
  const AgentModel model = s.model();
  if (auto violation = FindFilterConflict(model)) return violation;
  if (auto violation = FindLocalizationConflict(model)) return violation;
  if (auto violation = FindFreeConflict(model)) return violation;
  if (auto violation = FindPingConflict(model, s.world.sensing)) return violation;
  if (s.agent.observation.quality_medium > s.agent.observation.quality_high) {
    return config::Violation{{"observation.quality_medium", "observation.quality_high"},
                             "medium quality cannot begin above high quality"};
  }
  return {};
}

const std::vector<std::string>& KeysOfModel() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all = dynamics::KeysOnBoard();
    for (const char* key : {"channel.range_m", "channel.extended.attenuation_per_m",
                            "channel.extended.loss_probability", "channel.extended.loss_distance_m",
                            "channel.physical.modem.clock_offset_std_s",
                            "channel.physical.modem.clock_drift_std_ppm"}) {
      all.emplace_back(key);
    }
    return all;
  }();
  return keys;
}

AgentModel ModelOf(const RunConfig& run, const dynamics::WorldConfig& truth,
                   const acoustics::ChannelConfig& channel, const AgentConfig& agent,
                   const config::Differences& differences) {
  const dynamics::WorldConfig world = dynamics::Believed(truth, differences);
  acoustics::ChannelConfig links = channel;
  if (!differences.empty()) {
    config::Table table;
    Describe(&links, &table);
    config::Apply(differences, table);
  }
  AgentModel model{run,
                   world.vehicle,
                   world.workspace,
                   world.sea,
                   world.target,
                   world.navigation,
                   world.sensing,
                   world.control,
                   links,
                   agent.track,
                   agent.observation,
                   agent.task,
                   agent.fleet,
                   truth.current.largest_mps(),
                   agent.localization,
                   agent.stations};
  // The frame of an AUV may move with the water, and the target moves relative to it.
  if (model.locates()) {
    model.target.max_speed_mps += 2.0 * agent.localization.current_std_mps;
  }
  return model;
}

}  // namespace stg::agent

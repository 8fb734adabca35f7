#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acoustic_channel/channel_config.hpp"
#include "auv_dynamics/world/world_config.hpp"
#include "stg_agent/estimation/track_config.hpp"
#include "stg_agent/graph/observation_spec.hpp"
#include "stg_agent/localization/localization_config.hpp"
#include "stg_agent/stations/stations_config.hpp"

namespace stg::agent {

/// Which AUV follows which target: AUV i target i modulo their number, for good; or the one that it
/// chooses, for which it keeps a belief of every target and takes every detection.
enum class Assignment { kModulo, kFree };

/// What every AUV knows of its task.
struct TaskConfig {
  double desired_distance_m = 0.015;  ///< d*
  double lost_distance_m = 0.65;      ///< farther from the target than this, it counts as lost
  double lost_error_m = 0.0;  ///< judged: so does a target whose estimate is off by more; 0: no
  Assignment assignment = Assignment::kModulo;

  bool free() const { return assignment == Assignment::kFree; }
};

/// Members that leave the swarm and join it again: rows of a time from the start of the episode [s]
/// and the index of an AUV. One that has left is silent, hears and senses nothing, and its command
/// is to stand still; one that joins knows what its navigation says and nothing else.
struct FleetConfig {
  std::vector<std::vector<double>> leave, join;

  bool changes() const { return !leave.empty(); }
  /// The newest row of an AUV says whether it is there; of one without rows it is.
  bool present(int agent, double time_s) const;
};

/// The agents' own sections: how they track, what they observe, what they are to do.
struct AgentConfig {
  TrackConfig track;
  ObservationConfig observation;
  TaskConfig task;
  FleetConfig fleet;
  LocalizationConfig localization = {};
  StationsConfig stations = {};

  int observation_size() const { return ObservationSpec(observation).size(); }
};

/// All that an AUV may know before it is in the water: how many there are, its vehicle, where it
/// works, what it looks for and with what, the network. Apart from what is true, which it may
/// differ from; current, disturbance, contact and where things start are not in it.
struct AgentModel {
  RunConfig run;
  dynamics::VehicleConfig vehicle;
  dynamics::WorkspaceConfig workspace;
  dynamics::SeaConfig sea;
  dynamics::TargetConfig target;
  dynamics::NavigationConfig navigation;
  dynamics::SensingConfig sensing;
  dynamics::ControlConfig control;
  acoustics::ChannelConfig channel;
  TrackConfig track;
  ObservationConfig observation;
  TaskConfig task;
  FleetConfig fleet;
  double max_current_mps = 0.0;  ///< of the uniform current; packets must hold speeds over ground
  LocalizationConfig localization = {};
  StationsConfig stations = {};  ///< where beacons are charted, which craft there are

  double wall_m() const { return dynamics::WallOf(workspace, sea); }
  int members() const { return run.agents + stations.count(); }  ///< of the acoustic network
  /// Agents correct what they know of each other's positions.
  bool locates() const;
  /// By ranges from pings.
  bool pings_members() const { return locates() && localization.by == RangesBy::kPing; }
  int observation_size() const { return ObservationSpec(observation).size(); }
  /// Targets that each AUV keeps a belief of.
  int beliefs() const { return task.free() ? target.count : 1; }
};

/// Keys, units and ranges of the section.
void Describe(TaskConfig* c, config::Table* t);
void Describe(FleetConfig* c, config::Table* t);
void Describe(AgentConfig* c, config::Table* t);

/// Keys for which agents may have another value than the true one: dynamics::KeysOnBoard, and what
/// they take links for.
const std::vector<std::string>& KeysOfModel();

/// What the agents of a scenario know: its sections, but for what they believe otherwise.
/// @param differences of KeysOfModel
AgentModel ModelOf(const RunConfig& run, const dynamics::WorldConfig& truth,
                   const acoustics::ChannelConfig& channel, const AgentConfig& agent,
                   const config::Differences& differences);

/// What a program needs that runs an agent: the truth as the scenario says it, and the agents'
/// sections.
struct AgentScenario {
  RunConfig run;
  dynamics::WorldConfig world;
  acoustics::ChannelConfig channel;
  AgentConfig agent;
  config::Differences agent_model;

  AgentModel model() const { return ModelOf(run, world, channel, agent, agent_model); }
};
void Describe(AgentScenario* s, config::Table* t);
std::optional<config::Violation> FindConflict(const AgentScenario& s);

}  // namespace stg::agent

#pragma once

#include <algorithm>
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

/// How targets are assigned. kModulo: AUV i always follows target i modulo their number. kFree:
/// each AUV chooses; it estimates every target and uses every detection.
enum class Assignment { kModulo, kFree };

/// What every AUV knows of its task.
struct TaskConfig {
  double desired_distance_m = 0.015;  ///< d*
  double lost_distance_m = 0.65;      ///< a target farther away counts as lost
  double lost_error_m = 0.0;          ///< metrics: an estimate off by more counts as lost; 0: off
  Assignment assignment = Assignment::kModulo;

  bool free() const { return assignment == Assignment::kFree; }
};

/// AUVs that leave the swarm and join it again: rows of a time from the start of the episode [s]
/// and the index of an AUV. An AUV that has left sends, receives and senses nothing, and is
/// commanded to stand still. An AUV that joins has only the knowledge of its navigation.
struct FleetConfig {
  std::vector<std::vector<double>> leave, join;

  bool changes() const { return !leave.empty(); }
  /// Whether an AUV is in the swarm: its latest row decides. An AUV without rows is in the swarm.
  bool present(int agent, double time_s) const;
};

/// The agents' own sections: tracking, observation and task.
struct AgentConfig {
  TrackConfig track;
  ObservationConfig observation;
  TaskConfig task;
  FleetConfig fleet;
  LocalizationConfig localization = {};
  StationsConfig stations = {};

  int observation_size() const { return ObservationSpec(observation).size(); }
};

/// All that an AUV may know before it starts: the number of AUVs, its vehicle, workspace, targets,
/// sensor and network. It is separate from the true values and may differ from them. It contains no
/// disturbance, contact or start positions, and of the current only the largest speed.
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
  double max_current_mps = 0.0;  ///< no current of an episode is faster
  LocalizationConfig localization = {};
  StationsConfig stations = {};  ///< charted beacons, and surface craft

  double wall_m() const { return dynamics::WallOf(workspace, sea); }
  int members() const { return run.agents + stations.count(); }  ///< nodes of the acoustic network
  /// Whether a localizer corrects the AUVs' positions.
  bool locates() const;
  /// Whether the localizer uses ranges from pings.
  bool pings_members() const { return locates() && localization.by == RangesBy::kPing; }
  /// Whether the AUVs' modems measure the directions of received packets.
  bool measures_directions() const { return locates() && localization.usbl_std_deg > 0.0; }
  /// Whether AUVs surface for GPS fixes.
  bool surfaces() const { return locates() && localization.surface_std_m > 0.0; }
  int observation_size() const { return ObservationSpec(observation).size(); }
  /// Time between two looks of the sensor of the target [s].
  double look_period_s() const { return std::max(sensing.period_s, run.decision_dt_s()); }
  /// Number of targets that each AUV estimates.
  int beliefs() const { return task.free() ? target.count : 1; }
};

/// Keys, units and ranges of the section.
void Describe(TaskConfig* c, config::Table* t);
void Describe(FleetConfig* c, config::Table* t);
void Describe(AgentConfig* c, config::Table* t);

/// Lets keys of one section belong to what another section chooses: the world, or the agents' way
/// of measuring ranges. All sections must be in the table.
void OwnAcrossSections(const dynamics::WorldConfig* world, const acoustics::ChannelConfig* channel,
                       const AgentConfig* agent, config::Table* t);

/// Adds the section `believed`: what an agent's model has instead of the true values. All other
/// sections must be in the table.
void DescribeBelieved(const AgentConfig* agent, config::Differences* differences, config::Table* t);

/// Keys for which agents may have another value than the true one: dynamics::KeysOnBoard, and the
/// keys of their link estimate.
const std::vector<std::string>& KeysOfModel();

/// The model that the agents of a scenario have: its sections, changed by `differences`.
/// @param differences values of keys of KeysOfModel
AgentModel ModelOf(const RunConfig& run, const dynamics::WorldConfig& truth,
                   const acoustics::ChannelConfig& channel, const AgentConfig& agent,
                   const config::Differences& differences);

/// Sections that a program needs to run an agent: those of the true world, and the agents' own.
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

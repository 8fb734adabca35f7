#pragma once

#include <optional>

#include "acoustic_channel/channel_config.hpp"
#include "auv_dynamics/world/world_config.hpp"
#include "stg_agent/estimation/track_config.hpp"
#include "stg_agent/graph/observation_spec.hpp"

namespace stg::agent {

/// What every AUV knows of its task.
struct TaskConfig {
  double desired_distance_m = 0.015;  ///< d*
  double lost_distance_m = 0.65;      ///< farther from the target than this, it counts as lost
  double lost_error_m = 0.0;  ///< judged: so does a target whose estimate is off by more; 0: no
};

/// What an agent needs to know: its vehicle and world, the network, and its own sections.
struct AgentConfig : dynamics::WorldConfig {
  acoustics::ChannelConfig channel;
  TrackConfig track;
  ObservationConfig observation;
  TaskConfig task;

  int observation_size() const { return ObservationSpec(observation).size(); }
};

/// Keys, units and ranges of the section.
void Describe(TaskConfig* c, config::Table* t);
/// All that an agent reads.
void Describe(AgentConfig* c, config::Table* t);
/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const AgentConfig& c);

}  // namespace stg::agent

#pragma once

#include <optional>
#include <string>

#include "acoustic_channel/channel_config.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace stg::agent {

/// Which neighbours fill the slots of the observation, and in which order.
enum class NeighbourOrder { kNearest, kIndex };

/// The agents' target filter and their memory of neighbours.
struct TrackConfig {
  double process_accel_std_mps2 = 0.01;  ///< white acceleration of the target model
  double measurement_std_m = 0.001;      ///< floor of a detection's standard deviation
  double initial_speed_std_mps = 0.01;
  double gate_sigma = 5.0;  ///< own detections beyond it are set aside, three in a row restart
  double lost_std_m = 0.2;  ///< track no better than this counts as lost
  double neighbour_max_age_s = 10.0;  ///< a neighbour is forgotten after this silence
};

/// Constants of the observation that the paper leaves open (release's values).
struct ObservationConfig {
  bool tracking = true;  ///< Eq. 14, 8 numbers
  bool semantic = true;  ///< Eqs. 15-16, 9 numbers
  bool graph = true;     ///< Eq. 18, 6 numbers
  NeighbourOrder order = NeighbourOrder::kNearest;
  /// Truth mode only. As the release: the progress shown is always 0 (d(t-1) is
  /// overwritten first), so is the first P of an episode; mean_k(e) counts the
  /// current error twice; lost steps read one too many.
  bool release_bookkeeping = false;
  double distance_scale_m = 1.2;
  double error_scale_m = 0.8;
  double progress_scale_m = 0.04;
  double closing_scale_mps = 0.08;
  int error_window = 5;  ///< k of mean_k(e)
  double lost_scale_steps = 25.0;
  double near_range_m = 0.10;
  double quality_high = 0.75;
  double quality_medium = 0.40;
  double link_available = 0.10;  ///< q above this is an effective neighbour
  double role_confidence = 0.40;
};

/// What every AUV knows of its task.
struct TaskConfig {
  double desired_distance_m = 0.015;  ///< d*
  double lost_distance_m = 0.65;      ///< farther from the target than this, it counts as lost
};

/// What an agent needs to know: its vehicle and world, the network, and its own sections.
struct AgentConfig : dynamics::WorldConfig {
  acoustics::ChannelConfig channel;
  TrackConfig track;
  ObservationConfig observation;
  TaskConfig task;

  int observation_size() const {
    return 51 + (observation.tracking ? 8 : 0) + (observation.semantic ? 9 : 0) +
           (observation.graph ? 6 : 0);
  }
};

/// Keys, units and ranges of the sections.
void Describe(TrackConfig* c, config::Table* t);
void Describe(ObservationConfig* c, config::Table* t);
void Describe(TaskConfig* c, config::Table* t);
/// All that an agent reads.
void Describe(AgentConfig* c, config::Table* t);
/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const AgentConfig& c);

}  // namespace stg::agent

#pragma once

#include <string>

#include "auv_common/config/field.hpp"

namespace stg::agent {

/// Choice and order of the neighbours in the observation.
enum class NeighbourOrder { kNearest, kIndex };

/// Constants of the observation that the paper leaves open (release's values).
struct ObservationConfig {
  bool tracking = true;  ///< Eq. 14, 8 numbers
  bool semantic = true;  ///< Eqs. 15-16, 9 numbers
  bool graph = true;     ///< Eq. 18, 6 numbers
  bool links = true;     ///< false: the 3 link numbers of Eq. 18 read 0, an ablation
  bool roles = true;     ///< false: advantage and role of Eqs. 18-19 read 0, an ablation
  NeighbourOrder order = NeighbourOrder::kNearest;
  /// Truth mode only: errors of the release. The observed progress is always 0 (d(t-1) is
  /// overwritten first), and so is the first P of an episode; mean_k(e) counts the current error
  /// twice; lost steps are one too many.
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

/// Keys, units and ranges of the section.
void Describe(ObservationConfig* c, config::Table* t);

/// What reads a key of the section while a swarm flies. A run of nodes publishes the observation
/// (AgentStep, TaskState) whatever decides, so that there each key has an effect.
enum class ObservationReader {
  kVectorPolicy,  ///< only a policy whose input is the vector of the observation
  kPolicy,        ///< any policy: one over entities, too
  kTask           ///< reward or metrics, whatever decides
};

/// @param key full path, such as "observation.graph" Throws std::out_of_range for any other.
ObservationReader ReaderOf(const std::string& key);

}  // namespace stg::agent

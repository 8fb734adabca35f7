#pragma once

#include <string>
#include <vector>

#include "auv_common/config/options.hpp"

namespace stg::acoustics {

/// Queue of packets that cannot leave yet.
enum class QueuePolicy {
  kNewest,  ///< one packet waits, and a newer one replaces it: lowest age
  kFifo     ///< up to `queue_length` packets wait; more are refused
};

/// Keys of `channel.physical.modem`.
struct ModemConfig {
  std::string profile = "evologics_s2c";  ///< of ModemProfiles(), for every node
  std::vector<std::string> profiles;      ///< one for each node; empty: all have `profile`
  config::OptionsByName kinds = {};       ///< options of profiles that are registered
  int packet_bytes = 0;                   ///< longest payload of the network; 0: the frames'
  QueuePolicy queue = QueuePolicy::kNewest;
  int queue_length = 8;
  double clock_offset_std_s = 0.0;      ///< of a node's clock at the start of an episode
  double clock_drift_std_ppm = 0.0;     ///< of its rate
  double timing_std_s = 0.0;            ///< of a travel time that a modem measures
  double late_probability = 0.0;        ///< probability that a later arrival is measured
  double late_max_s = 0.1;              ///< largest delay of this arrival
  double freshness_s = 30.0;            ///< decay time of link quality with the age of information
  double source_level_offset_db = 0.0;  ///< added to the source level of every profile
};

void Describe(ModemConfig* c, config::Table* t);

}  // namespace stg::acoustics

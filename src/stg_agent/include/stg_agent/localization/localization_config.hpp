#pragma once

#include <string>

#include "auv_common/config/options.hpp"

namespace stg::agent {

/// Source of the ranges between members of the network.
enum class RangesBy {
  kOneWay,  ///< travel times of packets, which assume correct clocks
  kPing     ///< request and answer, measured by the own clock alone
};

/// Use of the modems' clocks by ranges from travel times.
enum class Clocks {
  kKnown,     ///< they are taken to be right
  kEstimated  ///< offset and rate of each one are states of the filter
};

/// How AUVs correct their reckoned positions.
struct LocalizationConfig {
  std::string kind = "uncorrected";  ///< name in the registry of localizers
  config::OptionsByName kinds = {};  ///< options of localizers that are registered
  // Of `ranges`: deviations of each horizontal component, and correlation times.
  double current_std_mps = 0.2;  ///< of the current that all AUVs share
  double current_memory_s = 43200.0;
  double shear_std_mps = 0.1;  ///< of the difference between an AUV's current and that
  double shear_memory_s = 10800.0;
  double shear_depth_m = 30.0;     ///< correlation depth of this difference
  double reckoning_std_m = 0.06;   ///< of the error that log and heading add per second
  double range_std_m = 1.0;        ///< of a range from a travel time
  double late_share = 0.02;        ///< share of ranges that are of a later arrival
  double late_max_m = 100.0;       ///< largest error of such a range
  double sound_speed_std = 0.001;  ///< of the relative error of the sound speed
  double gate_sigma = 4.0;         ///< ranges farther off than this are rejected
  RangesBy by = RangesBy::kOneWay;
  double ping_period_s = 30.0;  ///< time between two pings of an AUV
  /// Of the direction of a received packet, across the line of sight; 0: AUVs measure none.
  double usbl_std_deg = 0.0;
  Clocks clocks = Clocks::kKnown;
  /// An AUV surfaces for a fix before the deviation of its own position is above this; 0: never.
  double surface_std_m = 0.0;
};

/// Keys, units and ranges of the section, which a file may leave out.
void Describe(LocalizationConfig* c, config::Table* t);

}  // namespace stg::agent

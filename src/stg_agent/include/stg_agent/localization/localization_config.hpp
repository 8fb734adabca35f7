#pragma once

#include <string>

#include "auv_common/config/field.hpp"

namespace stg::agent {

/// What the ranges between members of the network are taken from.
enum class RangesBy {
  kOneWay,  ///< travel times of packets, which take all clocks for right
  kPing     ///< request and answer, for which the own clock alone counts
};

/// How an AUV finds out where it and its neighbours are, beside its own reckoning.
struct LocalizationConfig {
  std::string kind = "uncorrected";  ///< name in the registry of localizers
  // Of `ranges`: deviations of each horizontal component, and correlation times.
  double current_std_mps = 0.2;  ///< of the current that all AUVs share
  double current_memory_s = 43200.0;
  double shear_std_mps = 0.1;  ///< of what the current of one AUV differs from that by
  double shear_memory_s = 10800.0;
  double shear_depth_m = 30.0;     ///< correlation depth of it
  double reckoning_std_m = 0.06;   ///< of what log and heading add to a position in a second
  double range_std_m = 1.0;        ///< of a range from a travel time
  double late_share = 0.02;        ///< of ranges that are not of the first sound
  double late_max_m = 100.0;       ///< by which these are too long, at most
  double sound_speed_std = 0.001;  ///< of the share by which all ranges are too long
  double gate_sigma = 4.0;         ///< ranges farther off than this are set aside
  RangesBy by = RangesBy::kOneWay;
  double ping_period_s = 30.0;  ///< between two pings of an AUV, of the other members in turn
};

/// Keys, units and ranges of the section, which a file may leave out.
void Describe(LocalizationConfig* c, config::Table* t);

}  // namespace stg::agent

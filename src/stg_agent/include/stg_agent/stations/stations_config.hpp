#pragma once

#include <optional>
#include <vector>

#include "auv_common/config/field.hpp"
#include "auv_common/config/run_config.hpp"

namespace stg::agent {

/// Members of the acoustic network that send their own position: fixed beacons, and surface craft.
/// Their indices in the network follow those of the AUVs, beacons first.
struct StationsConfig {
  std::vector<std::vector<double>> beacons = {};  ///< rows of x, y, z as charted [m]
  double survey_std_m = 1.0;  ///< of each horizontal component of a charted position
  std::vector<std::vector<double>> crafts = {};  ///< rows of x, y at the start [m]
  double craft_speed_mps = 1.5;
  double craft_circle_m = 300.0;  ///< radius of the circle around the AUVs that it heard
  double gps_std_m = 2.0;         ///< of each horizontal component of a craft's position
  double gps_memory_s = 600.0;    ///< correlation time of that error
  double usbl_std_deg = 0.0;      ///< of the bearing of a received packet; 0: no USBL

  int count() const { return static_cast<int>(beacons.size() + crafts.size()); }
  bool is_craft(int station) const { return station >= static_cast<int>(beacons.size()); }
};

/// Keys, units and ranges of the section, which a file may leave out.
void Describe(StationsConfig* c, config::Table* t);

/// The clocks and nodes of the acoustic network: the AUVs, then the stations, then the transponders
/// of targets that are pinged.
RunConfig NetworkRun(const RunConfig& run, const StationsConfig& stations, int transponders = 0);

}  // namespace stg::agent

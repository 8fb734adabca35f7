#pragma once

#include <string>

#include "auv_common/config/options.hpp"

namespace stg::agent {

/// Model of the errors of observers' positions in the filter `measurements`. kSteps: they grow by
/// independent steps. kRates: they grow at lasting rates, as for AUVs that drift with the water.
/// kLocated: a localizer states them.
enum class ObserverErrors { kSteps, kRates, kLocated };

/// The agents' target filter and their memory of neighbours.
struct TrackConfig {
  std::string filter = "kalman";         ///< name in the registry of target filters
  config::OptionsByName filters = {};    ///< options of filters that are registered
  double process_accel_std_mps2 = 0.01;  ///< white acceleration of the target model
  double measurement_std_m = 0.001;      ///< floor of a detection's standard deviation
  double initial_speed_std_mps = 0.01;
  double gate_sigma = 5.0;  ///< farther own detections are rejected; three in a row restart
  double lost_std_m = 0.2;  ///< a less certain track counts as lost
  double neighbour_max_age_s = 10.0;  ///< a neighbour is forgotten after this silence
  double search_cell_m = 0.0;         ///< side of a cell of the search map; 0: no map
  // Of the filter `measurements`.
  double velocity_std_mps = 0.0;    ///< of the target, each component; 0: largest speed / root 2
  double velocity_memory_s = 60.0;  ///< correlation time of the target's velocity
  double memory_s = 60.0;           ///< largest age of a measurement
  double share_spacing_s = 2.0;     ///< least time between the measurements in one packet
  ObserverErrors observers = ObserverErrors::kSteps;
  double shear_std_mps = 0.1;       ///< rates: of the difference of currents between two AUVs
  double shear_memory_s = 10800.0;  ///< correlation time of it
};

/// Keys, units and ranges of the section.
void Describe(TrackConfig* c, config::Table* t);

}  // namespace stg::agent

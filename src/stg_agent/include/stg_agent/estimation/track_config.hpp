#pragma once

#include <string>

#include "auv_common/config/field.hpp"

namespace stg::agent {

/// How the errors of observers' positions behave in the filter `measurements`: they grow by
/// independent steps; or at rates that last, as those of AUVs that drift with the water do; or they
/// are what a localizer leaves of them.
enum class ObserverErrors { kSteps, kRates, kLocated };

/// The agents' target filter and their memory of neighbours.
struct TrackConfig {
  std::string filter = "kalman";         ///< name in the registry of target filters
  double process_accel_std_mps2 = 0.01;  ///< white acceleration of the target model
  double measurement_std_m = 0.001;      ///< floor of a detection's standard deviation
  double initial_speed_std_mps = 0.01;
  double gate_sigma = 5.0;  ///< own detections beyond it are set aside, three in a row restart
  double lost_std_m = 0.2;  ///< track no better than this counts as lost
  double neighbour_max_age_s = 10.0;  ///< a neighbour is forgotten after this silence
  double search_cell_m = 0.0;         ///< side of a cell of the search map; 0: the agents keep none
  // Of the filter `measurements`.
  double velocity_std_mps = 0.0;    ///< of the target, each component; 0: largest speed / root 2
  double velocity_memory_s = 60.0;  ///< correlation time of the target's velocity
  double memory_s = 60.0;           ///< measurements no older than this are taken
  double share_spacing_s = 2.0;     ///< least time between the measurements in one packet
  ObserverErrors observers = ObserverErrors::kSteps;
  double shear_std_mps = 0.1;       ///< rates: of what the water differs by between two depths
  double shear_memory_s = 10800.0;  ///< correlation time of it
};

/// Keys, units and ranges of the section.
void Describe(TrackConfig* c, config::Table* t);

}  // namespace stg::agent

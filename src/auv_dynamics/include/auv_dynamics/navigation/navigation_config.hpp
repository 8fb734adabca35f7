#pragma once

#include <string>

#include "auv_common/config/options.hpp"

namespace stg::dynamics {

/// Use of GPS fixes at the surface.
enum class FixUse {
  kCorrect,  ///< they correct the reckoned position
  kReported  ///< the agent gets them as readings; they do not correct the reckoned position
};

/// Navigation of the vehicles. Each episode, or each ping, draws errors with these deviations;
/// docs/navigation.md gives the sources of the numbers.
struct NavigationConfig {
  std::string kind = "perfect";      ///< name in the registry of navigation systems
  config::OptionsByName kinds = {};  ///< options of systems that are registered
  // Of dead_reckoning.
  double period_s = 1.0;          ///< between two pings of the Doppler log
  double dvl_scale_std = 0.002;   ///< scale error of the Doppler log
  double dvl_noise_mps = 0.01;    ///< noise of each horizontal component of a ping
  double dvl_altitude_m = 100.0;  ///< above this altitude it measures against the water
  double heading_std_deg = 0.3;   ///< constant error of the heading
  double gyro_walk_deg_per_sqrt_h = 0.1;
  double depth_std_m = 0.05;  ///< of the pressure gauge
  double gps_depth_m = 0.3;   ///< above this depth there are GPS fixes
  double gps_std_m = 3.0;     ///< of each horizontal component of a GPS fix
  FixUse fixes = FixUse::kCorrect;
  double gps_first_fix_s = 30.0;  ///< kReported: time at the surface before the first fix
  double gps_period_s = 600.0;    ///< kReported: time between two fixes, with independent errors
  double start_std_m = 1.0;       ///< of each horizontal component when an episode starts
  double current_std_mps = 0.1;   ///< of the current, which is unknown to the navigation
};

/// Keys, units and ranges of the section `navigation`, which a file may leave out.
void Describe(NavigationConfig* c, config::Table* t);

}  // namespace stg::dynamics

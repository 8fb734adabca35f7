#pragma once

#include <string>

#include "auv_common/config/field.hpp"

namespace stg::dynamics {

/// The agents' own target sensor.
struct SensingConfig {
  std::string sensor = "position";  ///< name in the registry of target sensors
  double range_m = 0.45;            ///< R_s: detection range and confidence scale (Eq. 13)
  double noise_std_m = 0.0;         ///< per component
  double detection_probability = 1.0;
  double dropout_rate_hz = 0.0;     ///< rate at which the sensor goes blind
  double dropout_duration_s = 1.0;  ///< mean duration of a blind spell
  double cue_std_m = 0.05;          ///< uncertainty of the initial datum, per component
};

/// Keys, units and ranges of the section.
void Describe(SensingConfig* c, config::Table* t);

}  // namespace stg::dynamics

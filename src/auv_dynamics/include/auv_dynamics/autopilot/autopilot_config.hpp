#pragma once

#include "auv_common/config/options.hpp"

namespace stg::dynamics {

/// Steering by a velocity command for vehicles that must keep moving. The gains are those of
/// normalised loops: the effect of the fins at the present speed is divided out with the vehicle's
/// constants.
struct AutopilotConfig {
  int period_steps = 1;        ///< physics steps between two commands to the actuators
  double min_speed_mps = 0.8;  ///< smallest commanded speed through the water
  double speed_integral_ps = 0.1;
  double course_gain_ps = 0.25;  ///< turn rate per course error
  double max_turn_rate_radps = 0.0873;
  double turn_gain_ps = 2.5;  ///< angular acceleration per error of the turn rate
  double turn_integral_ps2 = 0.6;
  double max_pitch_rad = 0.45;
  double climb_integral_ps = 0.1;
  double pitch_frequency_radps = 1.2;
  double pitch_integral_ps3 = 0.3;
  config::OptionsByName kinds = {};  ///< options of autopilots that are registered
};

/// Keys, units and ranges of the section `control.autopilot`, which a file may leave out.
void Describe(AutopilotConfig* c, config::Table* t);

}  // namespace stg::dynamics

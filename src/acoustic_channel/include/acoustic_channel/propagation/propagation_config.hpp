#pragma once

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel.physical.propagation`: propagation of sound from one vehicle to another.
struct PropagationConfig {
  double spreading = 1.5;  ///< k of 10 k lg d, of every path
  int paths = 1;           ///< straight one and images, in order of reflections
  double rician_k = 10.0;  ///< direct to scattered power, where paths is 1
  double wave_height_rms_m = 0.1;
  double bottom_density_ratio = 1.9;
  double bottom_speed_ratio = 1.1;
  double bottom_loss_db = 0.8;     ///< per wavelength, in the bottom
  double shadow_db = 30.0;         ///< loss on a blocked line
  double shadowing_db = 3.0;       ///< standard deviation of the slow fading of a link
  double shadowing_time_s = 10.0;  ///< time in which its autocorrelation falls to 1/e
};

void Describe(PropagationConfig* c, config::Table* t);

}  // namespace stg::acoustics

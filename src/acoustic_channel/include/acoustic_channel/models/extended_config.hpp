#pragma once

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel.extended`: Eq. 6 and the way of its packets.
struct ExtendedConfig {
  double sound_speed_mps = 1500.0;
  double max_range_m = 3.5;        ///< nothing arrives beyond
  double attenuation_per_m = 0.5;  ///< alpha
  double loss_probability = 0.10;  ///< at zero distance
  double loss_distance_m = 2.0;    ///< p_loss(d) = 1 - (1 - p0) exp(-(d / loss_distance)^2)
  double freshness_s = 2.0;        ///< tau_f
};
void Describe(ExtendedConfig* c, config::Table* t);

}  // namespace stg::acoustics

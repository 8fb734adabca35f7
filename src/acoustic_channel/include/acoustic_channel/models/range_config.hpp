#pragma once

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// `channel.range_m` and the keys of `channel.range`.
struct RangeConfig {
  double range_m = 0.45;              ///< R_c of Eq. 5
  double estimate_freshness_s = 2.0;  ///< decay time of shared estimates
};
void Describe(RangeConfig* c, config::Table* t);

}  // namespace stg::acoustics

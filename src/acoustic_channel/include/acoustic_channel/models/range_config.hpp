#pragma once

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel.range`.
struct RangeConfig {
  double freshness_s = 2.0;  ///< decay time of shared estimates
};
void Describe(RangeConfig* c, config::Table* t);

}  // namespace stg::acoustics

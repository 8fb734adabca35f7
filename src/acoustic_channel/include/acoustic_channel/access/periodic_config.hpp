#pragma once

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel.periodic`.
struct PeriodicConfig {
  double transmit_period_s = 0.5;  ///< every node sends one packet per period, staggered
};
void Describe(PeriodicConfig* c, config::Table* t);

}  // namespace stg::acoustics

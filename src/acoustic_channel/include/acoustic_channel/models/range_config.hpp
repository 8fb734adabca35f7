#pragma once

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel` that the model `range` reads.
struct RangeConfig {
  double range_m = 0.45;  ///< R_c of Eq. 5
};
void Describe(RangeConfig* c, config::Table* t);

}  // namespace stg::acoustics

#pragma once

#include <optional>

#include "auv_common/config/field.hpp"
#include "auv_common/config/run_config.hpp"

namespace stg::acoustics {

/// Keys of `channel` that the medium access `periodic` reads.
struct PeriodicConfig {
  double transmit_period_s = 0.5;  ///< every node sends one packet per period, staggered
};
void Describe(PeriodicConfig* c, config::Table* t);
std::optional<config::Violation> FindConflict(const PeriodicConfig& c, const RunConfig& run);

}  // namespace stg::acoustics

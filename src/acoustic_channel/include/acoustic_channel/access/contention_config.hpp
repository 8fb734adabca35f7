#pragma once

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel.contention`, which the medium accesses `aloha` and `csma` read.
struct ContentionConfig {
  double rest_s = 0.0;     ///< mean of the random rest after a transmission
  double backoff_s = 1.0;  ///< csma: longest first wait after a carrier was detected
};
/// Adds the keys of both rules, and the keys that only csma has.
void Describe(ContentionConfig* c, config::Table* t);
void DescribeBackoff(ContentionConfig* c, config::Table* t);

}  // namespace stg::acoustics

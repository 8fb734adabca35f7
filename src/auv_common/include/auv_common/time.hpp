#pragma once

#include <cstdint>

namespace stg {

/// Simulated time in integer nanoseconds, as in ros::Time.
using TimeNs = std::int64_t;
inline double Seconds(TimeNs t) { return static_cast<double>(t) * 1e-9; }

}  // namespace stg

#pragma once

#include "row.hpp"
#include "stg_agent/entities/entities.hpp"

namespace stg::agent {

/// Writes the rows of obstacles, the nearest first: those of the chart, and between walls also the
/// walls. Returns their number.
/// @param out [kObstacleRows]
int BuildObstacleRows(const EntityInput& in, const EntityScales& scales, const Frame& K,
                      float (*out)[kObstacleNumbers]);

}  // namespace stg::agent

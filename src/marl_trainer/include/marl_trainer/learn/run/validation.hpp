#pragma once

#include <vector>

#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/comm/team.hpp"
#include "stg_env/env/vector_env.hpp"
#include "stg_env/task/metrics.hpp"

namespace stg::learn {

/// Flies the deterministic policy of an algorithm on the same held-out episodes every time (seeds
/// kValidationSeed + r, in the scenario's own stage).
/// @param team each of its ranks flies a share of the episodes
/// @return one entry per episode, in order.
std::vector<task::EpisodeMetrics> Validate(const env::EnvFactory& make_env, int episodes,
                                           Algorithm* algorithm, const Team& team);

}  // namespace stg::learn

#pragma once

#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/algorithm.hpp"
#include "stg_env/scenario/scenario.hpp"
#include "stg_env/task/metrics.hpp"

namespace stg::learn {

/// Flies the deterministic policy of an algorithm on the same held-out episodes every time
/// (seeds kValidationSeed + r, in the scenario's own stage).
/// @param ranks that fly a share of them each; null: this process flies them all
/// @return one entry per episode, in order.
std::vector<task::EpisodeMetrics> Validate(const Scenario& scenario, int episodes,
                                           Algorithm* algorithm, WorkerPool* pool,
                                           Communicator* ranks = nullptr);

}  // namespace stg::learn

#pragma once

#include <functional>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "stg_env/env/decide.hpp"

namespace stg::env {

/// Chooses the actions [envs, agents, action_size] of all AUVs of `env` from its observations
/// [envs, agents, observation_size].
using ActFunction =
    std::function<void(const VectorEnv& env, const float* observations, double* actions)>;
/// Makes the ActFunction of one block of environments, which `worker` of the pool runs (0 without a
/// pool) for any number of episodes. The function may use only memory of its own or of that worker.
using ActFactory = std::function<ActFunction(const VectorEnv& env, int worker)>;

/// The episodes of an evaluation.
struct EvaluationOptions {
  int episodes = 30;
  std::uint64_t seed = 3000;  ///< episode e is drawn from world seed `seed` + e
  /// Environments that run together, a multiple of kMixBlock. Every block is full, so that results
  /// of an ActFunction for whole blocks do not depend on the number of episodes.
  int block = kMixBlock;
};

/// Runs whole episodes in environments of `make_env` on the threads of `pool`; null: on this one.
/// The result does not depend on the number of threads.
/// @param progress called with the number of finished episodes; may be empty.
std::vector<task::EpisodeMetrics> Evaluate(const EnvFactory& make_env, const ActFactory& make_act,
                                           const EvaluationOptions& options, WorkerPool* pool,
                                           const std::function<void(int)>& progress = {});
std::vector<task::EpisodeMetrics> Evaluate(const EnvFactory& make_env,
                                           const agent::Decider& controller,
                                           const EvaluationOptions& options, WorkerPool* pool,
                                           const std::function<void(int)>& progress = {});

}  // namespace stg::env

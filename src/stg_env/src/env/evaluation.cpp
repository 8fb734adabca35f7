#include "stg_env/env/evaluation.hpp"

#include <algorithm>
#include <cassert>
#include <mutex>

namespace stg::env {

std::vector<task::EpisodeMetrics> Evaluate(const EnvFactory& make_env, const ActFactory& make_act,
                                           const EvaluationOptions& options, WorkerPool* pool,
                                           const std::function<void(int)>& progress) {
  assert(options.episodes > 0 && options.block > 0 && options.block % kMixBlock == 0);
  const int blocks = (options.episodes + options.block - 1) / options.block;
  std::vector<task::EpisodeMetrics> metrics(static_cast<std::size_t>(blocks * options.block));
  std::mutex mutex;
  int finished = 0;
  const auto fly = [&](int b, int worker) {
    VectorEnvOptions o;
    o.seed = options.seed;
    o.envs = options.block;
    o.first_env = b * options.block;
    o.total_envs = blocks * options.block;
    VectorEnv env = make_env.Make(o);
    EnvMemory memory = env.MakeMemory();
    const ActFunction act = make_act(env, worker);
    std::vector<double> actions(
        static_cast<std::size_t>(env.envs() * env.agents() * env.action_size()));
    env.Reset(memory.arrays());
    do {
      act(env, memory.observations.data(), actions.data());
      env.Step(actions.data(), memory.arrays());
    } while (!memory.truncated.front());
    for (int e = 0; e < env.envs(); ++e) {
      metrics[static_cast<std::size_t>(o.first_env + e)] = env.metrics(e);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    finished = std::min(options.episodes, finished + options.block);
    if (progress) progress(finished);
  };
  if (pool != nullptr) {
    pool->Run(blocks, fly);
  } else {
    for (int b = 0; b < blocks; ++b) fly(b, 0);
  }
  metrics.resize(static_cast<std::size_t>(options.episodes));
  return metrics;
}

std::vector<task::EpisodeMetrics> Evaluate(const EnvFactory& make_env,
                                           const agent::Decider& controller,
                                           const EvaluationOptions& options, WorkerPool* pool,
                                           const std::function<void(int)>& progress) {
  const ActFactory make_act = [&controller](const VectorEnv&, int) -> ActFunction {
    return [&controller](const VectorEnv& env, const float* observations, double* actions) {
      Decide(controller, env, observations, actions);
    };
  };
  return Evaluate(make_env, make_act, options, pool, progress);
}

}  // namespace stg::env

#include "stg_env/env/evaluation.hpp"

#include <algorithm>
#include <cassert>
#include <memory>
#include <mutex>
#include <utility>

namespace stg::env {
namespace {

/// Environments in which a worker flies one block after another.
struct Flight {
  Flight(VectorEnv made, const ActFactory& make_act, int worker)
      : env(std::move(made)),
        memory(env.MakeMemory()),
        act(make_act(env, worker)),
        actions(static_cast<std::size_t>(env.envs() * env.agents() * env.action_size())) {}

  /// Flies the k-th episode of every environment.
  void Fly(int k) {
    env.RestartAt(static_cast<std::uint64_t>(k), memory.arrays());
    do {
      act(env, memory.observations.data(), actions.data());
      env.Step(actions.data(), memory.arrays());
    } while (!memory.truncated.front());
  }

  VectorEnv env;
  EnvMemory memory;
  ActFunction act;
  std::vector<double> actions;
};

}  // namespace

std::vector<task::EpisodeMetrics> Evaluate(const EnvFactory& make_env, const ActFactory& make_act,
                                           const EvaluationOptions& options, WorkerPool* pool,
                                           const std::function<void(int)>& progress) {
  assert(options.episodes > 0 && options.block > 0 && options.block % kMixBlock == 0);
  const int blocks = (options.episodes + options.block - 1) / options.block;
  std::vector<task::EpisodeMetrics> metrics(static_cast<std::size_t>(blocks * options.block));
  // A worker makes environments once. Of a mix of n scenarios, block b has the scenarios of block b
  // modulo n.
  const int kinds = make_env.scenarios();
  const int workers = pool == nullptr ? 1 : pool->workers();
  std::vector<std::unique_ptr<Flight>> flights(static_cast<std::size_t>(workers * kinds));
  std::mutex mutex;
  int finished = 0;
  const auto fly = [&](int b, int worker) {
    std::unique_ptr<Flight>& flight = flights[static_cast<std::size_t>(worker * kinds + b % kinds)];
    if (flight == nullptr) {
      VectorEnvOptions o;
      o.seed = options.seed;
      o.envs = options.block;
      o.first_env = b % kinds * options.block;
      o.total_envs = kinds * options.block;
      flight = std::make_unique<Flight>(make_env.Make(o), make_act, worker);
    }
    flight->Fly(b / kinds);
    for (int e = 0; e < options.block; ++e) {
      metrics[static_cast<std::size_t>(b * options.block + e)] = flight->env.metrics(e);
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

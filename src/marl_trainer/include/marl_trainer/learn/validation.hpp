#pragma once

#include <memory>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/env/env.hpp"
#include "marl_trainer/learn/nn/actor_critic.hpp"

namespace stg::learn {

/// Flies the deterministic policy on the same held-out episodes every time
/// (seeds kValidationSeed + r, the scenario's own stage and reward).
class Validation {
 public:
  Validation(const Scenario& scenario, const ActorCritic& networks, int episodes, WorkerPool* pool);
  ~Validation();

  /// @param parameters of the networks. Returns one entry per episode, in order.
  std::vector<task::EpisodeMetrics> Run(const float* parameters, const Normaliser& observations);

 private:
  struct Unit;

  const ActorCritic& networks_;
  const int episode_steps_, episodes_;
  WorkerPool* pool_;
  std::vector<std::unique_ptr<Unit>> units_;
};

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

/// What one shard's collection is to an on-policy algorithm. Index [t][e][agent]; environment
/// steps [t][e] are the samples of an update.
struct RolloutBuffer {
  std::vector<float> observations;  ///< [T, E, N, F], normalised
  std::vector<float> actions;       ///< [T, E, N, A], before clipping
  std::vector<float> log_prob;      ///< [T, E, N], of those actions
  std::vector<float> teacher;       ///< [T, E, N, A], what the controller to imitate does; or empty
  std::vector<float> states;        ///< [T, E, S], normalised
  std::vector<float> rewards;       ///< [T, E], mean over agents
  std::vector<std::uint8_t> done;   ///< [T, E]
  std::vector<float> final_states;  ///< [ends, S], normalised, in the order of final_samples
  std::vector<int> final_samples;   ///< [ends], t * E + e of the steps that ended an episode
  std::vector<float> last_states;   ///< [E, S], normalised, after the last step

  // Written by algorithms with a critic.
  std::vector<float> values;        ///< [T, E], in units of reward
  std::vector<float> final_values;  ///< [T, E], of the pre-reset state; where done
  std::vector<float> bootstrap;     ///< [E], of the last states
  std::vector<float> advantages;    ///< [T, E]

  int steps = 0, envs = 0, agents = 0;
  Shard shard;
  int samples() const { return steps * envs; }

  /// Sizes the arrays for a collection; allocates when it is larger than the one before.
  void Begin(const Problem& problem, int steps, int envs, bool taught);
  /// Stores step transition.step.
  void Add(const Problem& problem, const Transition& transition, const Normaliser& observations,
           const Normaliser& states);
};

}  // namespace stg::learn

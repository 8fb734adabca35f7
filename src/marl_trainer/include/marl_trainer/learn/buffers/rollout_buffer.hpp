#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

/// Collection of one shard for an on-policy algorithm. Index [t][e][agent]; the samples of an
/// update are environment steps [t][e].
struct RolloutBuffer {
  std::vector<float> observations;  ///< [T, E, N, F], normalised
  std::vector<float> actions;       ///< [T, E, N, A], before clipping
  std::vector<float> log_prob;      ///< [T, E, N], of these actions
  std::vector<float> teacher;       ///< [T, E, N, A], actions of the teacher; or empty
  std::vector<float> states;        ///< [T, E, S], normalised
  std::vector<float> rewards;       ///< [T, E], mean over agents
  std::vector<std::uint8_t> done;   ///< [T, E]
  std::vector<float> final_states;  ///< [ends, S], normalised, in the order of final_samples
  std::vector<int> final_samples;   ///< [ends], t * E + e of the steps at which an episode ended
  std::vector<float> last_states;   ///< [E, S], normalised, after the last step

  // Written by algorithms with a critic.
  std::vector<float> values;        ///< [T, E], in units of reward
  std::vector<float> final_values;  ///< [T, E], of the state before the reset; only where done
  std::vector<float> bootstrap;     ///< [E], of the last states
  std::vector<float> advantages;    ///< [T, E]

  int steps = 0, envs = 0, agents = 0;
  Shard shard;
  int samples() const { return steps * envs; }

  /// Sets the sizes of the arrays for a collection. Allocates only if it is larger than the
  /// previous one.
  void Begin(const Problem& problem, int steps, int envs, bool taught);
  /// Stores step transition.step.
  void Add(const Problem& problem, const Transition& transition, const Normaliser& observations,
           const Normaliser& states);
};

}  // namespace stg::learn

#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/ppo_loss.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_samples.hpp"

namespace stg::learn {

/// The AUVs whose rows a batch has: one of them, or all.
struct AuvRange {
  int first = 0, count = 1;
};

/// Memory to gather samples of a minibatch in, for one pass through a network.
class PpoRows {
 public:
  /// @param rows at most
  PpoRows(const ActorCritic& networks, int rows);

  /// What the actor's loss reads of the samples at places from .. to-1, rows of some AUVs.
  /// @param weights of the advantages, by sample; null: 1
  PpoBatch Actor(const PpoSamples& samples, int from, int to, const AuvRange& auvs,
                 const std::vector<double>* weights, float imitation);
  /// What the critic's loss reads of them.
  PpoBatch Critic(const PpoSamples& samples, int from, int to);

 private:
  const std::size_t inputs_, action_size_, state_size_;
  std::vector<float> observations_, actions_, teacher_, log_prob_;  // as in PpoBatch
  std::vector<float> states_, advantages_, targets_;
};

}  // namespace stg::learn

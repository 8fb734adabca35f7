#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/ppo_loss.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_samples.hpp"

namespace stg::learn {

/// The AUVs whose rows are in a batch: one AUV or all.
struct AuvRange {
  int first = 0, count = 1;
};

/// Memory in which the samples of a minibatch are gathered, for one pass through a network.
class PpoRows {
 public:
  /// @param rows largest number of rows
  PpoRows(const ActorCritic& networks, int rows);

  /// Inputs of the actor's loss for the samples at places from .. to-1, with the rows of some AUVs.
  /// @param weights factors of the advantages, by sample; null: 1
  PpoBatch Actor(const PpoSamples& samples, int from, int to, const AuvRange& auvs,
                 const std::vector<double>* weights, float imitation);
  /// Inputs of the critic's loss for these samples.
  PpoBatch Critic(const PpoSamples& samples, int from, int to);

 private:
  const std::size_t inputs_, action_size_, state_size_;
  std::vector<float> observations_, actions_, teacher_, log_prob_;  // as in PpoBatch
  std::vector<float> states_, advantages_, targets_;
};

}  // namespace stg::learn

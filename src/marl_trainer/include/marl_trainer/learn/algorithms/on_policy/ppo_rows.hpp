#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/ppo_loss.hpp"

namespace stg::learn {

/// Memory to gather the samples of one pass through the networks.
struct PpoRows {
  /// @param samples at most, `agents` rows each
  PpoRows(const ActorCritic& networks, int samples, int agents);

  /// The first `count` samples.
  PpoBatch Batch(int count, float imitation) const;

  const int agents;
  std::vector<float> observations, actions, teacher, log_prob;  ///< as in PpoBatch
  std::vector<float> states, advantages, targets;
};

}  // namespace stg::learn

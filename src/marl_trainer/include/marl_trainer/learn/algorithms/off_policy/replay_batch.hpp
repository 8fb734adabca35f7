#pragma once

#include <vector>

#include "marl_trainer/learn/buffers/replay_buffer.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

/// Scales between raw numbers and the inputs and outputs of off-policy networks.
///
/// The mean m of the rewards is subtracted, and the result is divided by s = std(r) / (1 - gamma).
/// Every episode ends by truncation. So the shift moves all values by the same m / (1 - gamma) and
/// changes no decision: Q = s q + m / (1 - gamma), where networks predict q.
struct ReplayScales {
  Normaliser observations, states;
  float action = 1.0F;  ///< raw actions are in +-action; the inputs of networks are in +-1
  float reward_mean = 0.0F, reward_std = 1.0F;
  float value_mean = 0.0F;  ///< m / (1 - gamma)
};

/// Samples as inputs of networks: normalised, in rows.
struct ReplayBatch {
  /// Memory for up to `rows` samples.
  /// @param own_rewards also store the rewards of each AUV
  ReplayBatch(const Problem& problem, int rows, bool own_rewards = false);

  /// Writes sample number `row`.
  void Set(int row, const ReplayBuffer::Sample& sample, const ReplayScales& scales);
  /// Scales the raw own_rewards of sample number `row`, which the caller has written. Call Set
  /// before.
  void ScaleOwnRewards(int row, const ReplayBuffer::Sample& sample, const ReplayScales& scales);

  std::vector<float> observations, next_observations;  ///< [rows, agents, observation_size]
  std::vector<float> states, next_states;              ///< [rows, state_size]
  std::vector<float> actions;                          ///< [rows, agents, action_size], in +-1
  std::vector<float> rewards, discounts;               ///< [rows]; q = reward + discount * next q
  std::vector<float> own_rewards;                      ///< [rows, agents], or empty
  int count = 0;

 private:
  const int agents_, observation_size_, state_size_, joint_action_;
};

}  // namespace stg::learn

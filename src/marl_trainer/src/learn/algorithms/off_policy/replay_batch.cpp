#include "marl_trainer/learn/algorithms/off_policy/replay_batch.hpp"

namespace stg::learn {

ReplayBatch::ReplayBatch(const Problem& problem, int rows, bool own)
    : agents_(problem.agents),
      observation_size_(problem.observation_size),
      state_size_(problem.state_size),
      joint_action_(problem.agents * problem.action_size) {
  const auto n = static_cast<std::size_t>(rows);
  observations.resize(n * static_cast<std::size_t>(agents_ * observation_size_));
  next_observations.resize(observations.size());
  states.resize(n * static_cast<std::size_t>(state_size_));
  next_states.resize(states.size());
  actions.resize(n * static_cast<std::size_t>(joint_action_));
  rewards.resize(n);
  discounts.resize(n);
  if (own) own_rewards.resize(n * static_cast<std::size_t>(agents_));
}

void ReplayBatch::Set(int row, const ReplayBuffer::Sample& sample, const ReplayScales& scales) {
  const auto r = static_cast<std::ptrdiff_t>(row);
  const std::ptrdiff_t seen = r * agents_ * observation_size_;
  scales.observations.Apply(sample.observations, agents_, observations.data() + seen);
  scales.observations.Apply(sample.next_observations, agents_, next_observations.data() + seen);
  scales.states.Apply(sample.state, 1, states.data() + r * state_size_);
  scales.states.Apply(sample.next_state, 1, next_states.data() + r * state_size_);
  float* action = actions.data() + r * joint_action_;
  for (int a = 0; a < joint_action_; ++a) action[a] = sample.actions[a] / scales.action;
  const auto i = static_cast<std::size_t>(row);
  rewards[i] = (sample.reward - scales.reward_mean * sample.weight) / scales.reward_std;
  discounts[i] = sample.discount;
}

void ReplayBatch::ScaleOwnRewards(int row, const ReplayBuffer::Sample& sample,
                                  const ReplayScales& scales) {
  float* own = own_rewards.data() + static_cast<std::ptrdiff_t>(row) * agents_;
  for (int i = 0; i < agents_; ++i) {
    own[i] = (own[i] - scales.reward_mean * sample.weight) / scales.reward_std;
  }
}

}  // namespace stg::learn

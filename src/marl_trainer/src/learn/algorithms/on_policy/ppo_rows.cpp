#include "marl_trainer/learn/algorithms/on_policy/ppo_rows.hpp"

#include <algorithm>

namespace stg::learn {

PpoRows::PpoRows(const ActorCritic& networks, int rows)
    : inputs_(static_cast<std::size_t>(networks.actor.inputs())),
      action_size_(static_cast<std::size_t>(networks.action_size())),
      state_size_(static_cast<std::size_t>(networks.critic.inputs())),
      log_prob_(static_cast<std::size_t>(rows)),
      advantages_(log_prob_.size()),
      targets_(log_prob_.size()) {
  observations_.resize(log_prob_.size() * inputs_);
  actions_.resize(log_prob_.size() * action_size_);
  teacher_.resize(actions_.size());
  states_.resize(log_prob_.size() * state_size_);
}

PpoBatch PpoRows::Actor(const PpoSamples& samples, int from, int to, const AuvRange& auvs,
                        const std::vector<double>* weights, float imitation) {
  const auto count = static_cast<std::size_t>(auvs.count);
  for (int place = from; place < to; ++place) {
    const std::size_t sample = samples.at(place);
    const RolloutBuffer& b = samples.rollout(sample);
    const std::size_t row = samples.index(sample) * static_cast<std::size_t>(b.agents) +
                            static_cast<std::size_t>(auvs.first);
    const std::size_t at = static_cast<std::size_t>(place - from), to_row = at * count;
    const auto copy = [&](const std::vector<float>& all, std::size_t size, std::vector<float>* to) {
      std::copy_n(all.data() + row * size, count * size, to->data() + to_row * size);
    };
    copy(b.observations, inputs_, &observations_);
    copy(b.actions, action_size_, &actions_);
    if (imitation > 0.0F) copy(b.teacher, action_size_, &teacher_);
    copy(b.log_prob, 1, &log_prob_);
    const double weight = weights == nullptr ? 1.0 : (*weights)[sample];
    advantages_[at] = static_cast<float>(weight * static_cast<double>(samples.advantage(sample)));
  }
  PpoBatch batch;
  batch.count = to - from;
  batch.agents = auvs.count;
  batch.observations = observations_.data();
  batch.actions = actions_.data();
  batch.log_prob = log_prob_.data();
  batch.advantages = advantages_.data();
  batch.teacher = teacher_.data();
  batch.imitation = imitation;
  return batch;
}

PpoBatch PpoRows::Critic(const PpoSamples& samples, int from, int to) {
  for (int place = from; place < to; ++place) {
    const std::size_t sample = samples.at(place);
    const auto at = static_cast<std::size_t>(place - from);
    std::copy_n(samples.rollout(sample).states.data() + samples.index(sample) * state_size_,
                state_size_, states_.data() + at * state_size_);
    targets_[at] = samples.target(sample);
  }
  PpoBatch batch;
  batch.count = to - from;
  batch.states = states_.data();
  batch.targets = targets_.data();
  return batch;
}

}  // namespace stg::learn

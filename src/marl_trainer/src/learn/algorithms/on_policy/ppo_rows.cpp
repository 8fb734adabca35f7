#include "marl_trainer/learn/algorithms/on_policy/ppo_rows.hpp"

namespace stg::learn {

PpoRows::PpoRows(const ActorCritic& networks, int samples, int per_sample)
    : agents(per_sample),
      log_prob(static_cast<std::size_t>(samples * per_sample)),
      advantages(static_cast<std::size_t>(samples)),
      targets(advantages.size()) {
  observations.resize(log_prob.size() * static_cast<std::size_t>(networks.actor.inputs()));
  actions.resize(log_prob.size() * static_cast<std::size_t>(networks.action_size()));
  teacher.resize(actions.size());
  states.resize(targets.size() * static_cast<std::size_t>(networks.critic.inputs()));
}

PpoBatch PpoRows::Batch(int count, float imitation) const {
  PpoBatch batch;
  batch.count = count;
  batch.agents = agents;
  batch.observations = observations.data();
  batch.actions = actions.data();
  batch.log_prob = log_prob.data();
  batch.states = states.data();
  batch.advantages = advantages.data();
  batch.targets = targets.data();
  batch.teacher = teacher.data();
  batch.imitation = imitation;
  return batch;
}

}  // namespace stg::learn

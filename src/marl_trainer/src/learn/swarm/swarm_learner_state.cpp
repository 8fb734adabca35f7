#include <algorithm>
#include <utility>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/swarm/swarm_learner.hpp"

/// Where a SwarmLearner begins, what it writes, and its policies.
namespace stg::learn {

agent::EntityPolicy SwarmLearner::Policy(const agent::PolicyMetadata& metadata) const {
  return PolicyOf(actor_numbers_, metadata);
}

agent::EntityPolicy SwarmLearner::AveragePolicy(const agent::PolicyMetadata& metadata) const {
  return PolicyOf(averaged_ > 0.0 ? average_ : actor_numbers_, metadata);
}

agent::EntityPolicy SwarmLearner::PolicyOf(const std::vector<float>& numbers,
                                           const agent::PolicyMetadata& metadata) const {
  agent::EntityPolicy::Parameters p;
  p.numbers.assign(numbers.begin(), numbers.end() - size_);
  p.log_std.assign(numbers.end() - size_, numbers.end());
  p.noise_time_s = config_.noise_time_s;
  p.action = config_.action;
  p.network = config_.network;
  p.metadata = metadata;
  return agent::EntityPolicy(std::move(p));
}

void SwarmLearner::Save(Archive* archive) const {
  archive->Put("actor", actor_numbers_);
  archive->Put("critic", critic_numbers_);
  archive->Put("average", average_);
  actor_adam_.Save("actor_adam", archive);
  critic_adam_.Save("critic_adam", archive);
  archive->Put("returns", std::vector<double>{mean_, square_, seen_, std_, averaged_});
}

void SwarmLearner::StartFrom(const agent::EntityPolicy& policy) {
  const agent::EntityPolicy::Parameters& p = policy.parameters();
  if (p.network != config_.network || p.action != config_.action) {
    throw UserError("policy '" + p.metadata.id + "': has the network '" +
                    agent::EntityNetworkName(p.network) + "' and the action '" +
                    agent::EntityActionName(p.action) + "', not '" +
                    agent::EntityNetworkName(config_.network) + "' and '" +
                    agent::EntityActionName(config_.action) + "'");
  }
  std::copy(p.numbers.begin(), p.numbers.end(), actor_numbers_.begin());
  std::copy(p.log_std.begin(), p.log_std.end(), actor_numbers_.end() - size_);
  RequireBlind("policy '" + p.metadata.id + "'");
  without_critic_ = true;
}

void SwarmLearner::RequireBlind(const std::string& start) const {
  for (std::size_t k = 0; k < blind_.size(); ++k) {
    if (!blind_[k] || actor_numbers_[k] == 0.0F) continue;
    throw UserError(start + ": uses an input that this training withholds (--without, " +
                    "--last-command; its config.json has its own)");
  }
}

void SwarmLearner::SetDeviation(double log_std) {
  std::fill(actor_numbers_.end() - size_, actor_numbers_.end(), static_cast<float>(log_std));
}

void SwarmLearner::Load(const Archive& archive) {
  const std::vector<float>& actor = archive.Floats("actor", actor_numbers_.size());
  const std::vector<float>& critic = archive.Floats("critic", critic_numbers_.size());
  const std::vector<float>& average = archive.Floats("average", average_.size());
  const std::vector<double>& returns = archive.Doubles("returns", 5);
  actor_adam_.Load("actor_adam", archive);
  critic_adam_.Load("critic_adam", archive);
  actor_numbers_ = actor;
  critic_numbers_ = critic;
  average_ = average;
  mean_ = returns[0];
  square_ = returns[1];
  seen_ = returns[2];
  std_ = returns[3];
  averaged_ = returns[4];
}

}  // namespace stg::learn

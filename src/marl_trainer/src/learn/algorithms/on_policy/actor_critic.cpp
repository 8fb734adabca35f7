#include "marl_trainer/learn/algorithms/on_policy/actor_critic.hpp"

namespace stg::learn {
namespace {

NetworkSpec ActorSpec(const Problem& problem, const PpoOptions& config) {
  NetworkSpec spec;
  spec.inputs = problem.observation_size;
  spec.hidden = config.actor_hidden;
  spec.activation = ActivationNamed(config.activation);
  spec.outputs = problem.action_size;
  spec.squash = static_cast<float>(problem.action_scale);
  spec.output_gain = 0.01F;  // an untrained policy hardly moves
  return spec;
}

NetworkSpec CriticSpec(const Problem& problem, const PpoOptions& config) {
  NetworkSpec spec;
  spec.inputs = problem.state_size;
  spec.hidden = config.critic_hidden;
  spec.activation = ActivationNamed(config.activation);
  return spec;
}

}  // namespace

ActorCritic::ActorCritic(const Problem& problem, const PpoOptions& config)
    : actor(ActorSpec(problem, config)), critic(CriticSpec(problem, config)) {}

std::vector<float> ActorCritic::Initialise(std::uint64_t seed, double log_std) const {
  std::vector<float> p(parameters());
  actor.Initialise(seed, 0, log_std, p.data());
  InitialiseOrthogonally(critic.spec(), seed, 1, p.data() + critic_offset());
  return p;
}

}  // namespace stg::learn

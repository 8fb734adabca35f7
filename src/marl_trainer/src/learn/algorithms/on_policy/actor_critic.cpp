#include "marl_trainer/learn/algorithms/on_policy/actor_critic.hpp"

#include "auv_common/numbers/random.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

NetworkSpec ActorSpec(const Problem& problem, const PpoOptions& config) {
  NetworkSpec spec;
  spec.inputs = problem.observation_size;
  spec.hidden = config.actor_hidden;
  spec.activation = config.activation;
  spec.outputs = problem.action_size;
  spec.squash = static_cast<float>(problem.action_scale);
  spec.output_gain = 0.01F;  // an untrained policy outputs almost zero
  return spec;
}

NetworkSpec CriticSpec(const Problem& problem, const PpoOptions& config) {
  NetworkSpec spec;
  spec.inputs = problem.state_size;
  spec.hidden = config.critic_hidden;
  spec.activation = config.activation;
  return spec;
}

}  // namespace

ActorCritic::ActorCritic(const Problem& problem, const PpoOptions& config)
    : actor(ActorSpec(problem, config)), critic(CriticSpec(problem, config)) {}

Trained ActorCritic::NewActor(std::uint64_t seed, int i, double log_std) const {
  std::vector<float> numbers(actor.parameters());
  // The critic is network 1 of a seed.
  actor.Initialise(seed, static_cast<std::uint32_t>(i == 0 ? 0 : i + 1), log_std, numbers.data());
  return Trained(std::move(numbers));
}

Trained ActorCritic::NewCritic(std::uint64_t seed) const {
  std::vector<float> numbers(critic.parameters());
  InitialiseOrthogonally(critic.spec(), seed, 1, numbers.data());
  return Trained(std::move(numbers));
}

void ActorCritic::Explore(const Trained& trained_actor, const DrawKeys& keys, int agents, int row,
                          const Actions& out) const {
  Random random(keys.seed, Stream::kPolicy, keys.collection, keys.step,
                static_cast<std::uint32_t>(keys.first_env * agents + row));
  const float log_prob = agent::SampleGaussian(
      trained_actor.numbers.data() + actor.log_std_offset(), action_size(), &random,
      out.actions + static_cast<std::ptrdiff_t>(row) * action_size());
  if (out.log_prob != nullptr) out.log_prob[row] = log_prob;
}

void Trained::Save(const std::string& name, Archive* archive) const {
  archive->Put(name, numbers);
  adam.Save(name + "_adam", archive);
}

void Trained::Load(const std::string& name, const Archive& archive) {
  const std::vector<float>& theirs = archive.Floats(name, numbers.size());
  adam.Load(name + "_adam", archive);
  numbers = theirs;
}

}  // namespace stg::learn

#include "marl_trainer/learn/algorithms/maddpg/maddpg.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"

namespace stg::learn {
namespace {

NetworkSpec DeterministicSpec(const Problem& problem, const ReplayOptions& options) {
  NetworkSpec spec;
  spec.inputs = problem.observation_size;
  spec.hidden = options.actor_hidden;
  spec.activation = options.activation;
  spec.outputs = problem.action_size;
  spec.squash = 1.0F;
  spec.output_gain = 0.01F;  // an untrained policy outputs almost zero
  return spec;
}

float Clip(float x, float limit) { return std::min(std::max(x, -limit), limit); }

}  // namespace

struct Maddpg::Scratch {
  Scratch(const Mlp& actor_network, const JointCritics& joint, int agents, int joint_action,
          int rows)
      : actor(actor_network, rows * agents),
        critics(joint, rows * agents),
        states(static_cast<std::size_t>(rows * agents * joint.network().inputs())),
        actions(static_cast<std::size_t>(rows * agents * joint_action)),
        d_actions(actions.size()),
        d_own(static_cast<std::size_t>(rows * joint_action)),
        values(static_cast<std::size_t>(rows * agents)) {}
  Mlp::Workspace actor;
  JointCritics::Scratch critics;
  std::vector<float> states, actions, d_actions, d_own, values;
};

Maddpg::Maddpg(const ReplayOptions& options, const DeterministicOptions& own,
               const TrainConfig& common, const Problem& problem, const Team& team)
    : CentralCriticLearner(options, DeterministicSpec(problem, options), own.critics, common,
                           problem, team),
      own_(own),
      others_act_now_(own.others == OthersAct::kNow),
      actor_target_(actor_parameters()) {
  Keep("target_actor", &actor_target_);
  for (int s = 0; s < kGroups; ++s) {
    scratch_.push_back(std::make_unique<Scratch>(
        actor(), critics(), problem.agents, problem.agents * problem.action_size, slice_rows()));
  }
}

Maddpg::~Maddpg() = default;

void Maddpg::Act(const Decision& decision, const Actions& out) {
  const int agents = problem().agents, size = problem().action_size;
  const int rows = decision.envs * agents;
  const float scale = scales().action;
  const float* mean =
      acting(decision.worker)
          .Evaluate(actor_parameters().data(), scales().observations, decision.observations, rows);
  for (int i = 0; i < rows * size; ++i) out.actions[i] = scale * mean[i];
  if (decision.explore == nullptr) return;
  const DrawKeys& keys = *decision.explore;
  for (int r = 0; r < rows; ++r) {
    Random random(keys.seed, Stream::kPolicy, keys.collection, keys.step,
                  static_cast<std::uint32_t>(keys.first_env * agents + r));
    const double noise = own_.noise.At(Rank(keys.first_env + r / agents));
    float* action = out.actions + static_cast<std::ptrdiff_t>(r) * size;
    for (int a = 0; a < size; ++a) {
      const float x = warming_up()
                          ? static_cast<float>(random.Uniform(-1.0, 1.0))
                          : action[a] / scale + static_cast<float>(noise * random.Normal());
      action[a] = scale * Clip(x, 1.0F);
    }
  }
}

void Maddpg::AddCriticGradient(const StepContext& step, int slice, float* gradient, Sums* sums) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int rows = batch.count * problem().agents;
  actor().Forward(actor_target_.data(), batch.next_observations.data(), rows, &s.actor);
  const int count = rows * problem().action_size;
  std::copy_n(s.actor.output(), count, s.actions.data());
  if (own_.target_noise > 0.0) {
    Random random(seed(), Stream::kTargetNoise, step.number, 0, static_cast<std::uint32_t>(slice));
    const auto limit = static_cast<float>(own_.target_noise_clip);
    for (int i = 0; i < count; ++i) {
      const float noise = Clip(static_cast<float>(own_.target_noise * random.Normal()), limit);
      float& action = s.actions[static_cast<std::size_t>(i)];
      action = Clip(action + noise, 1.0F);
    }
  }
  critics().Target(batch.next_states.data(), s.actions.data(), batch.count, &s.critics,
                   s.values.data());
  for (int r = 0; r < batch.count; ++r) {
    const auto i = static_cast<std::size_t>(r);
    s.values[i] = batch.rewards[i] + batch.discounts[i] * s.values[i];
  }
  sums->squares = critics().AddGradient(
      batch, s.values.data(), 1.0F / static_cast<float>(base().batch), &s.critics, gradient);
}

/// The loss of each AUV has a joint action: its own action from the actor, and the actions of the
/// others.
void Maddpg::AddActorGradient(const StepContext&, int slice, float* gradient, Sums* sums) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int agents = problem().agents, size = problem().action_size, joint = agents * size;
  const int state = problem().state_size;
  actor().Forward(actor_parameters().data(), batch.observations.data(), batch.count * agents,
                  &s.actor);
  const float* own = s.actor.output();
  const int copies = others_act_now_ ? 1 : agents;  // joint actions per sample
  const int rows = batch.count * copies;
  if (others_act_now_) {
    std::copy_n(own, batch.count * joint, s.actions.data());
    std::copy_n(batch.states.data(), batch.count * state, s.states.data());
  } else {
    for (int r = 0; r < rows; ++r) {
      const int sample = r / agents, agent = r % agents;
      float* actions = s.actions.data() + static_cast<std::ptrdiff_t>(r) * joint;
      std::copy_n(batch.actions.data() + static_cast<std::ptrdiff_t>(sample) * joint, joint,
                  actions);
      std::copy_n(own + static_cast<std::ptrdiff_t>(r) * size, size, actions + agent * size);
      std::copy_n(batch.states.data() + static_cast<std::ptrdiff_t>(sample) * state, state,
                  s.states.data() + static_cast<std::ptrdiff_t>(r) * state);
    }
  }
  // The loss is minus the value, as a sum over AUVs and a mean over samples.
  critics().ActionGradient(s.states.data(), s.actions.data(), rows,
                           -1.0F / static_cast<float>(base().batch), false, &s.critics,
                           s.values.data(), s.d_actions.data());
  const float* d_own = s.d_actions.data();
  if (copies > 1) {
    for (int r = 0; r < rows; ++r) {
      std::copy_n(s.d_actions.data() + static_cast<std::ptrdiff_t>(r) * joint + (r % agents) * size,
                  size, s.d_own.data() + static_cast<std::ptrdiff_t>(r) * size);
    }
    d_own = s.d_own.data();
  }
  actor().Backward(actor_parameters().data(), batch.observations.data(), d_own,
                   batch.count * agents, &s.actor, gradient);
  double sum = 0.0;
  for (int r = 0; r < rows; ++r) sum += static_cast<double>(s.values[static_cast<std::size_t>(r)]);
  sums->value = sum / copies;
}

void Maddpg::Step(const StepContext& step) {
  TrainCritics(step);
  if (step.number % static_cast<std::uint32_t>(own_.policy_delay) != 0) return;
  TrainActor(step);
  critics().MoveTargets(base().tau);
  MoveTowards(actor_parameters(), base().tau, &actor_target_);
}

Maddpg::Products Maddpg::ProductsPerSample() const {
  const int agents = problem().agents;
  const NetworkSpec& q = critics().network().spec();
  return {own_.critics * (q.forward_products() + q.training_products()) +
              agents * actor().spec().forward_products(),
          agents * actor().spec().training_products() +
              2.0 * q.forward_products() * (others_act_now_ ? 1 : agents)};
}

std::vector<agent::Policy> Maddpg::Policies(const agent::PolicyMetadata& metadata) const {
  NetworkSpec spec = actor().spec();
  spec.squash = scales().action;
  std::vector<float> parameters = actor_parameters();
  // Standard deviation of the exploration in a graph of nodes.
  const double noise = std::max(own_.noise.min, 1e-3) * static_cast<double>(scales().action);
  parameters.insert(parameters.end(), static_cast<std::size_t>(problem().action_size),
                    static_cast<float>(std::log(noise)));
  return {GaussianActor(spec).ToPolicy(parameters.data(), scales().observations, metadata)};
}

}  // namespace stg::learn

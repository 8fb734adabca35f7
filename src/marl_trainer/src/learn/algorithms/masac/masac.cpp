#include "marl_trainer/learn/algorithms/masac/masac.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"

namespace stg::learn {
namespace {

/// Purposes of the draws of a gradient step.
constexpr int kNextActions = 0, kOwnActions = 1;

NetworkSpec SoftSpec(const Problem& problem, const ReplayOptions& options) {
  NetworkSpec spec;
  spec.inputs = problem.observation_size;
  spec.hidden = options.actor_hidden;
  spec.activation = options.activation;
  spec.outputs = 2 * problem.action_size;
  spec.output_gain = 0.01F;  // the mean of an untrained policy is almost zero
  return spec;
}

}  // namespace

struct Masac::Scratch {
  Scratch(const Mlp& actor_network, const JointCritics& joint, const Problem& p, int samples)
      : actor(actor_network, samples * p.agents), critics(joint, samples) {
    const auto rows = static_cast<std::size_t>(samples * p.agents);
    const auto size = static_cast<std::size_t>(p.action_size);
    for (auto* per_action : {&noise, &actions, &d_actions}) per_action->resize(rows * size);
    d_outputs.resize(2 * rows * size);
    log_prob.resize(rows);
    values.resize(static_cast<std::size_t>(samples));
  }
  Mlp::Workspace actor;
  JointCritics::Scratch critics;
  std::vector<float> noise, actions, d_actions, d_outputs, log_prob, values;
};

Masac::Masac(const ReplayOptions& options, const SoftOptions& own, const TrainConfig& common,
             const Problem& problem, const Team& team)
    : CentralCriticLearner(options, SoftSpec(problem, options), 2, common, problem, team),
      own_(own),
      range_{static_cast<float>(own.min_log_std), static_cast<float>(own.max_log_std)},
      log_alpha_(1, static_cast<float>(std::log(own.initial_alpha))),
      alpha_adam_(1),
      noise_(static_cast<std::size_t>(team.pool->workers()),
             std::vector<float>(static_cast<std::size_t>(problem.action_size))) {
  Keep("log_alpha", &log_alpha_, false);
  Keep("alpha_adam", &alpha_adam_);
  for (int s = 0; s < kGroups; ++s) {
    scratch_.push_back(std::make_unique<Scratch>(actor(), critics(), problem, slice_rows()));
  }
}

Masac::~Masac() = default;

double Masac::alpha() const { return std::exp(static_cast<double>(log_alpha_[0])); }

void Masac::Act(const Decision& decision, const Actions& out) {
  const int agents = problem().agents, size = problem().action_size;
  const int rows = decision.envs * agents;
  const float scale = scales().action;
  const float* output =
      acting(decision.worker)
          .Evaluate(actor_parameters().data(), scales().observations, decision.observations, rows);
  std::vector<float>& noise = noise_[static_cast<std::size_t>(decision.worker)];
  for (int r = 0; r < rows; ++r) {
    const float* own = output + static_cast<std::ptrdiff_t>(r) * 2 * size;
    float* action = out.actions + static_cast<std::ptrdiff_t>(r) * size;
    if (decision.explore == nullptr) {
      for (int a = 0; a < size; ++a) action[a] = scale * std::tanh(own[a]);
      continue;
    }
    const DrawKeys& keys = *decision.explore;
    Random random(keys.seed, Stream::kPolicy, keys.collection, keys.step,
                  static_cast<std::uint32_t>(keys.first_env * agents + r));
    if (warming_up()) {
      for (int a = 0; a < size; ++a) action[a] = static_cast<float>(random.Uniform(-1.0, 1.0));
    } else {
      for (float& z : noise) z = static_cast<float>(random.Normal());
      SquashedSample(range_, own, noise.data(), size, action);
    }
    for (int a = 0; a < size; ++a) action[a] *= scale;
  }
}

void Masac::Sample(const float* observations, int rows, const StepContext& step, int purpose,
                   int slice) {
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int size = problem().action_size;
  actor().Forward(actor_parameters().data(), observations, rows, &s.actor);
  Random random(seed(), Stream::kTargetNoise, step.number, static_cast<std::uint32_t>(purpose),
                static_cast<std::uint32_t>(slice));
  for (int i = 0; i < rows * size; ++i) {
    s.noise[static_cast<std::size_t>(i)] = static_cast<float>(random.Normal());
  }
  for (int r = 0; r < rows; ++r) {
    const auto at = static_cast<std::ptrdiff_t>(r) * size;
    s.log_prob[static_cast<std::size_t>(r)] = SquashedSample(
        range_, s.actor.output() + 2 * at, s.noise.data() + at, size, s.actions.data() + at);
  }
}

void Masac::AddCriticGradient(const StepContext& step, int slice, float* gradient, Sums* sums) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int agents = problem().agents;
  const auto weight = static_cast<float>(alpha());
  Sample(batch.next_observations.data(), batch.count * agents, step, kNextActions, slice);
  critics().Target(batch.next_states.data(), s.actions.data(), batch.count, &s.critics,
                   s.values.data());
  for (int r = 0; r < batch.count; ++r) {
    const auto i = static_cast<std::size_t>(r);
    float log_prob = 0.0F;
    for (int k = 0; k < agents; ++k)
      log_prob += s.log_prob[static_cast<std::size_t>(r * agents + k)];
    s.values[i] = batch.rewards[i] + batch.discounts[i] * (s.values[i] - weight * log_prob);
  }
  sums->squares = critics().AddGradient(
      batch, s.values.data(), 1.0F / static_cast<float>(base().batch), &s.critics, gradient);
}

void Masac::AddActorGradient(const StepContext& step, int slice, float* gradient, Sums* sums) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int rows = batch.count * problem().agents, size = problem().action_size;
  const float weight = 1.0F / static_cast<float>(base().batch);
  Sample(batch.observations.data(), rows, step, kOwnActions, slice);
  // The loss is alpha sum_i log pi_i - min Q, as a mean over samples.
  critics().ActionGradient(batch.states.data(), s.actions.data(), batch.count, -weight, true,
                           &s.critics, s.values.data(), s.d_actions.data());
  const float d_log_prob = static_cast<float>(alpha()) * weight;
  for (int r = 0; r < rows; ++r) {
    const auto at = static_cast<std::ptrdiff_t>(r) * size;
    SquashedGradient(range_, s.actor.output() + 2 * at, s.noise.data() + at, s.actions.data() + at,
                     s.d_actions.data() + at, d_log_prob, size, s.d_outputs.data() + 2 * at);
  }
  actor().Backward(actor_parameters().data(), batch.observations.data(), s.d_outputs.data(), rows,
                   &s.actor, gradient);
  for (int r = 0; r < batch.count; ++r) {
    sums->value += static_cast<double>(s.values[static_cast<std::size_t>(r)]);
  }
  for (int r = 0; r < rows; ++r) {
    sums->entropy -= static_cast<double>(s.log_prob[static_cast<std::size_t>(r)]);
  }
}

void Masac::Step(const StepContext& step) {
  TrainCritics(step);
  const double entropy = TrainActor(step).entropy;
  // Derivative of log alpha (entropy - target) by log alpha.
  const auto gradient = static_cast<float>(entropy - own_.target_entropy * problem().action_size);
  const Adam adam(base().adam_eps, &alpha_adam_);
  adam.Apply(0, 1, own_.alpha_lr * step.rate, 1.0F, &gradient, log_alpha_.data());
  critics().MoveTargets(base().tau);
}

Masac::Products Masac::ProductsPerSample() const {
  const int agents = problem().agents;
  const NetworkSpec& q = critics().network().spec();
  return {agents * actor().spec().forward_products() +
              2.0 * (q.forward_products() + q.training_products()),
          agents * actor().spec().training_products() + 4.0 * q.forward_products()};
}

UpdateReport Masac::Report(int steps) {
  const Means means = TakeMeans(steps);
  return {{means.learning_rate, means.critic_loss, means.value, alpha(), means.entropy,
           means.actor_norm, means.critic_norm},
          Flops(steps, means.actor_steps)};
}

std::vector<ReportColumn> Masac::Columns() const {
  return {{"learning_rate", "", 0},       {"critic_loss", "TD", 5}, {"value", "Q", 2},
          {"alpha", "alpha", 5},          {"entropy", "H", 2},      {"actor_gradient_norm", "", 0},
          {"critic_gradient_norm", "", 0}};
}

std::vector<agent::Policy> Masac::Policies(const agent::PolicyMetadata& metadata) const {
  NetworkSpec spec = actor().spec();
  spec.outputs = problem().action_size;
  spec.squash = scales().action;
  // Takes the rows of the means in the last layer, then their biases.
  const int last = actor().layers() - 1;
  const auto size = static_cast<std::ptrdiff_t>(problem().action_size);
  const auto weight = static_cast<std::ptrdiff_t>(actor().weight_offset(last));
  const auto bias = static_cast<std::ptrdiff_t>(actor().bias_offset(last));
  const auto from = actor_parameters().begin();
  std::vector<float> parameters(from, from + weight + size * actor().spec().layer_inputs(last));
  parameters.insert(parameters.end(), from + bias, from + bias + size);
  // Standard deviation of the exploration in a graph of nodes. It depends on the observation; this
  // is its middle.
  const float log_std = SquashedLogStd(
      range_, actor_parameters()[actor().bias_offset(last) + static_cast<std::size_t>(size)]);
  parameters.insert(parameters.end(), static_cast<std::size_t>(size),
                    log_std + std::log(scales().action));
  return {GaussianActor(spec).ToPolicy(parameters.data(), scales().observations, metadata)};
}

std::vector<NetworkSize> Masac::Sizes() const {
  std::vector<NetworkSize> sizes = CentralCriticLearner::Sizes();
  sizes.push_back({"entropy_weight", log_alpha_.size()});
  return sizes;
}

}  // namespace stg::learn

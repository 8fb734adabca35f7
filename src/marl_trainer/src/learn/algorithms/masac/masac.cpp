#include "marl_trainer/learn/algorithms/masac/masac.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"

namespace stg::learn {
namespace {

/// What the draws of a gradient step are for.
constexpr int kNextActions = 0, kOwnActions = 1;

NetworkSpec SoftSpec(const Problem& problem, const ReplayOptions& options) {
  NetworkSpec spec;
  spec.inputs = problem.observation_size;
  spec.hidden = options.actor_hidden;
  spec.activation = ActivationNamed(options.activation);
  spec.outputs = 2 * problem.action_size;
  spec.output_gain = 0.01F;  // an untrained policy hardly moves, but for its spread
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
  double value_sum = 0.0, log_prob_sum = 0.0;
};

struct Masac::Acting {
  explicit Acting(const Mlp& network) : actor(network, 0) {}
  Mlp::Workspace actor;
  std::vector<float> observations;  // normalised
  std::vector<float> noise;         // of one AUV
};

Masac::Masac(const ReplayOptions& options, const SoftOptions& own, const TrainConfig& common,
             const Problem& problem, WorkerPool* pool)
    : ReplayLearner(options, common, problem, pool),
      own_(own),
      range_{static_cast<float>(own.min_log_std), static_cast<float>(own.max_log_std)},
      actor_(SoftSpec(problem, options)),
      critics_(problem, options, 2, common.seed),
      actor_parameters_(actor_.parameters()),
      log_alpha_(1, static_cast<float>(std::log(own.initial_alpha))),
      actor_adam_(actor_.parameters()),
      critic_adam_(critics_.parameters().size()),
      alpha_adam_(1),
      actor_gradient_(actor_.parameters(), pool),
      critic_gradient_(critics_.parameters().size(), pool) {
  InitialiseOrthogonally(actor_.spec(), common.seed, 0, actor_parameters_.data());
  for (int s = 0; s < SlicedGradient::kSlices; ++s) {
    scratch_.push_back(std::make_unique<Scratch>(actor_, critics_, problem, slice_rows()));
  }
  for (int w = 0; w < pool->workers(); ++w) acting_.push_back(std::make_unique<Acting>(actor_));
}

Masac::~Masac() = default;

double Masac::alpha() const { return std::exp(static_cast<double>(log_alpha_[0])); }

void Masac::Act(const Decision& decision, const Actions& out) {
  Acting& s = *acting_[static_cast<std::size_t>(decision.worker)];
  const int agents = problem().agents, size = problem().action_size;
  const int rows = decision.envs * agents;
  const float scale = scales().action;
  if (s.actor.rows() < rows) s.actor = Mlp::Workspace(actor_, rows);
  s.observations.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(actor_.inputs()));
  s.noise.resize(static_cast<std::size_t>(size));
  scales().observations.Apply(decision.observations, rows, s.observations.data());
  actor_.Forward(actor_parameters_.data(), s.observations.data(), rows, &s.actor);
  for (int r = 0; r < rows; ++r) {
    const float* output = s.actor.output() + static_cast<std::ptrdiff_t>(r) * 2 * size;
    float* action = out.actions + static_cast<std::ptrdiff_t>(r) * size;
    if (decision.explore == nullptr) {
      for (int a = 0; a < size; ++a) action[a] = scale * std::tanh(output[a]);
      continue;
    }
    const DrawKeys& keys = *decision.explore;
    Random random(keys.seed, Stream::kPolicy, keys.collection, keys.step,
                  static_cast<std::uint32_t>(keys.first_env * agents + r));
    if (warming_up()) {
      for (int a = 0; a < size; ++a) action[a] = static_cast<float>(random.Uniform(-1.0, 1.0));
    } else {
      for (float& z : s.noise) z = static_cast<float>(random.Normal());
      SquashedSample(range_, output, s.noise.data(), size, action);
    }
    for (int a = 0; a < size; ++a) action[a] *= scale;
  }
}

void Masac::Sample(const float* observations, int rows, const StepContext& step, int purpose,
                   int slice) {
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int size = problem().action_size;
  actor_.Forward(actor_parameters_.data(), observations, rows, &s.actor);
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

double Masac::AddCriticGradient(const StepContext& step, int slice, float* gradient) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int agents = problem().agents;
  const auto weight = static_cast<float>(alpha());
  Sample(batch.next_observations.data(), batch.count * agents, step, kNextActions, slice);
  critics_.Target(batch.next_states.data(), s.actions.data(), batch.count, &s.critics,
                  s.values.data());
  for (int r = 0; r < batch.count; ++r) {
    const auto i = static_cast<std::size_t>(r);
    float log_prob = 0.0F;
    for (int k = 0; k < agents; ++k)
      log_prob += s.log_prob[static_cast<std::size_t>(r * agents + k)];
    s.values[i] = batch.rewards[i] + batch.discounts[i] * (s.values[i] - weight * log_prob);
  }
  return critics_.AddGradient(batch, s.values.data(), 1.0F / static_cast<float>(base().batch),
                              &s.critics, gradient);
}

void Masac::AddActorGradient(const StepContext& step, int slice, float* gradient) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int rows = batch.count * problem().agents, size = problem().action_size;
  const float weight = 1.0F / static_cast<float>(base().batch);
  Sample(batch.observations.data(), rows, step, kOwnActions, slice);
  // The loss is alpha sum_i log pi_i - min Q, the mean over samples.
  critics_.ActionGradient(batch.states.data(), s.actions.data(), batch.count, -weight, true,
                          &s.critics, s.values.data(), s.d_actions.data());
  const float d_log_prob = static_cast<float>(alpha()) * weight;
  for (int r = 0; r < rows; ++r) {
    const auto at = static_cast<std::ptrdiff_t>(r) * size;
    SquashedGradient(range_, s.actor.output() + 2 * at, s.noise.data() + at, s.actions.data() + at,
                     s.d_actions.data() + at, d_log_prob, size, s.d_outputs.data() + 2 * at);
  }
  actor_.Backward(actor_parameters_.data(), batch.observations.data(), s.d_outputs.data(), rows,
                  &s.actor, gradient);
  s.value_sum = s.log_prob_sum = 0.0;
  for (int r = 0; r < batch.count; ++r) {
    s.value_sum += static_cast<double>(s.values[static_cast<std::size_t>(r)]);
  }
  for (int r = 0; r < rows; ++r) {
    s.log_prob_sum += static_cast<double>(s.log_prob[static_cast<std::size_t>(r)]);
  }
}

void Masac::TrainActor(const StepContext& step) {
  actor_gradient_.Compute(0, base().batch, [&](int slice, int, int, int, float* gradient) {
    AddActorGradient(step, slice, gradient);
  });
  const Adam adam(base().adam_eps, &actor_adam_);
  actor_norm_ += actor_gradient_.Apply(adam, 0, actor_.parameters(), base().lr * step.rate,
                                       base().grad_clip, actor_parameters_.data());
  double value = 0.0, log_prob = 0.0;
  for (const auto& s : scratch_) {
    value += s->value_sum;
    log_prob += s->log_prob_sum;
  }
  const double entropy = -log_prob / (base().batch * problem().agents);
  values_ += value / base().batch;
  entropy_ += entropy;
  // d / d log alpha of log alpha (entropy - target).
  const auto gradient = static_cast<float>(entropy - own_.target_entropy * problem().action_size);
  const Adam alpha_step(base().adam_eps, &alpha_adam_);
  alpha_step.Apply(0, 1, own_.alpha_lr * step.rate, 1.0F, &gradient, log_alpha_.data());
}

void Masac::Step(const StepContext& step) {
  rate_ = step.rate;
  std::array<double, SlicedGradient::kSlices> squares{};
  critic_gradient_.Compute(0, base().batch, [&](int slice, int, int, int, float* gradient) {
    squares[static_cast<std::size_t>(slice)] = AddCriticGradient(step, slice, gradient);
  });
  const Adam adam(base().adam_eps, &critic_adam_);
  critic_norm_ +=
      critic_gradient_.Apply(adam, 0, critics_.parameters().size(), base().critic_lr * step.rate,
                             base().grad_clip, critics_.parameters().data());
  for (const double part : squares) squares_ += part / base().batch;
  TrainActor(step);
  critics_.MoveTargets(base().tau);
}

void Masac::RescaleValues(double ratio, double shift) { critics_.RescaleValues(ratio, shift); }

UpdateReport Masac::Report(int steps) {
  const double n = std::max(steps, 1);
  const int agents = problem().agents;
  const NetworkSpec& q = critics_.network().spec();
  UpdateReport report;
  report.values = {base().lr * rate_,
                   squares_ / n,
                   static_cast<double>(scales().reward_std) * (values_ / n) +
                       static_cast<double>(scales().value_mean),
                   alpha(),
                   entropy_ / n,
                   actor_norm_ / n,
                   critic_norm_ / n};
  const double products =
      agents * (actor_.spec().forward_products() + actor_.spec().training_products()) +
      2.0 * (3.0 * q.forward_products() + q.training_products());
  report.flops = 2.0 * base().batch * steps * products;
  squares_ = values_ = entropy_ = actor_norm_ = critic_norm_ = 0.0;
  return report;
}

std::vector<ReportColumn> Masac::Columns() const {
  return {{"learning_rate", "", 0},       {"critic_loss", "TD", 5}, {"value", "Q", 2},
          {"alpha", "alpha", 5},          {"entropy", "H", 2},      {"actor_gradient_norm", "", 0},
          {"critic_gradient_norm", "", 0}};
}

void Masac::Save(Archive* archive) const {
  ReplayLearner::Save(archive);
  critics_.Save(archive);
  archive->Put("actor", actor_parameters_);
  archive->Put("log_alpha", log_alpha_);
  actor_adam_.Save("actor_adam", archive);
  critic_adam_.Save("critic_adam", archive);
  alpha_adam_.Save("alpha_adam", archive);
}

void Masac::Load(const Archive& archive) {
  const std::vector<float>& actor = archive.Floats("actor", actor_parameters_.size());
  const std::vector<float>& log_alpha = archive.Floats("log_alpha", 1);
  critics_.Load(archive);
  actor_adam_.Load("actor_adam", archive);
  critic_adam_.Load("critic_adam", archive);
  alpha_adam_.Load("alpha_adam", archive);
  ReplayLearner::Load(archive);
  actor_parameters_ = actor;
  log_alpha_ = log_alpha;
}

void Masac::StartFrom(const Archive& archive) {
  ReplayLearner::StartFrom(archive);
  critics_.Load(archive);
  actor_parameters_ = archive.Floats("actor", actor_parameters_.size());
}

std::vector<agent::Policy> Masac::Policies(const agent::PolicyMetadata& metadata) const {
  NetworkSpec spec = actor_.spec();
  spec.outputs = problem().action_size;
  spec.squash = scales().action;
  // The rows of the means in the last layer, then their biases.
  const int last = actor_.layers() - 1;
  const auto size = static_cast<std::ptrdiff_t>(problem().action_size);
  const auto weight = static_cast<std::ptrdiff_t>(actor_.weight_offset(last));
  const auto bias = static_cast<std::ptrdiff_t>(actor_.bias_offset(last));
  const auto from = actor_parameters_.begin();
  std::vector<float> parameters(from, from + weight + size * actor_.spec().layer_inputs(last));
  parameters.insert(parameters.end(), from + bias, from + bias + size);
  // What a graph explores with: the spread differs with the observation; this is its middle.
  const float log_std = SquashedLogStd(
      range_, actor_parameters_[actor_.bias_offset(last) + static_cast<std::size_t>(size)]);
  parameters.insert(parameters.end(), static_cast<std::size_t>(size),
                    log_std + std::log(scales().action));
  return {GaussianActor(spec).ToPolicy(parameters.data(), scales().observations, metadata)};
}

}  // namespace stg::learn

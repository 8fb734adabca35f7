#include "marl_trainer/learn/algorithms/maddpg/maddpg.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"

namespace stg::learn {
namespace {

NetworkSpec DeterministicSpec(const Problem& problem, const ReplayOptions& options) {
  NetworkSpec spec;
  spec.inputs = problem.observation_size;
  spec.hidden = options.actor_hidden;
  spec.activation = ActivationNamed(options.activation);
  spec.outputs = problem.action_size;
  spec.squash = 1.0F;
  spec.output_gain = 0.01F;  // an untrained policy hardly moves
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

struct Maddpg::Acting {
  explicit Acting(const Mlp& network) : actor(network, 0) {}
  Mlp::Workspace actor;
  std::vector<float> observations;  // normalised
};

Maddpg::Maddpg(const ReplayOptions& options, const DeterministicOptions& own,
               const TrainConfig& common, const Problem& problem, WorkerPool* pool)
    : ReplayLearner(options, common, problem, pool),
      own_(own),
      actor_(DeterministicSpec(problem, options)),
      critics_(problem, options, own.critics, common.seed),
      actor_parameters_(actor_.parameters()),
      actor_adam_(actor_.parameters()),
      critic_adam_(critics_.parameters().size()),
      actor_gradient_(actor_.parameters(), pool),
      critic_gradient_(critics_.parameters().size(), pool) {
  InitialiseOrthogonally(actor_.spec(), common.seed, 0, actor_parameters_.data());
  actor_target_ = actor_parameters_;
  for (int s = 0; s < SlicedGradient::kSlices; ++s) {
    scratch_.push_back(std::make_unique<Scratch>(
        actor_, critics_, problem.agents, problem.agents * problem.action_size, slice_rows()));
  }
  for (int w = 0; w < pool->workers(); ++w) acting_.push_back(std::make_unique<Acting>(actor_));
}

Maddpg::~Maddpg() = default;

void Maddpg::Act(const Decision& decision, const Actions& out) {
  Acting& s = *acting_[static_cast<std::size_t>(decision.worker)];
  const int agents = problem().agents, size = problem().action_size;
  const int rows = decision.envs * agents;
  const float scale = scales().action;
  if (s.actor.rows() < rows) s.actor = Mlp::Workspace(actor_, rows);
  s.observations.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(actor_.inputs()));
  scales().observations.Apply(decision.observations, rows, s.observations.data());
  actor_.Forward(actor_parameters_.data(), s.observations.data(), rows, &s.actor);
  const float* mean = s.actor.output();
  for (int i = 0; i < rows * size; ++i) out.actions[i] = scale * mean[i];
  if (decision.explore == nullptr) return;
  const DrawKeys& keys = *decision.explore;
  for (int r = 0; r < rows; ++r) {
    Random random(keys.seed, Stream::kPolicy, keys.collection, keys.step,
                  static_cast<std::uint32_t>(keys.first_env * agents + r));
    const double rank = Rank(keys.first_env + r / agents);
    const double noise = own_.noise_max > 0.0
                             ? own_.noise_min * std::pow(own_.noise_max / own_.noise_min, rank)
                             : 0.0;
    float* action = out.actions + static_cast<std::ptrdiff_t>(r) * size;
    for (int a = 0; a < size; ++a) {
      const float x = warming_up()
                          ? static_cast<float>(random.Uniform(-1.0, 1.0))
                          : action[a] / scale + static_cast<float>(noise * random.Normal());
      action[a] = scale * Clip(x, 1.0F);
    }
  }
}

double Maddpg::AddCriticGradient(const StepContext& step, int slice, float* gradient) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int rows = batch.count * problem().agents;
  actor_.Forward(actor_target_.data(), batch.next_observations.data(), rows, &s.actor);
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
  critics_.Target(batch.next_states.data(), s.actions.data(), batch.count, &s.critics,
                  s.values.data());
  for (int r = 0; r < batch.count; ++r) {
    const auto i = static_cast<std::size_t>(r);
    s.values[i] = batch.rewards[i] + batch.discounts[i] * s.values[i];
  }
  return critics_.AddGradient(batch, s.values.data(), 1.0F / static_cast<float>(base().batch),
                              &s.critics, gradient);
}

double Maddpg::TrainCritics(const StepContext& step) {
  std::array<double, SlicedGradient::kSlices> squares{};
  critic_gradient_.Compute(0, base().batch, [&](int slice, int, int, int, float* gradient) {
    squares[static_cast<std::size_t>(slice)] = AddCriticGradient(step, slice, gradient);
  });
  const Adam adam(base().adam_eps, &critic_adam_);
  critic_norm_ +=
      critic_gradient_.Apply(adam, 0, critics_.parameters().size(), base().critic_lr * step.rate,
                             base().grad_clip, critics_.parameters().data());
  double sum = 0.0;
  for (const double part : squares) sum += part;
  return sum / base().batch;
}

/// The joint actions that each AUV's loss is about: its own from the actor, and the others'.
double Maddpg::AddActorGradient(int slice, float* gradient) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const int agents = problem().agents, size = problem().action_size, joint = agents * size;
  const int state = problem().state_size;
  actor_.Forward(actor_parameters_.data(), batch.observations.data(), batch.count * agents,
                 &s.actor);
  const float* own = s.actor.output();
  int rows = batch.count;
  if (own_.others == "policy") {
    std::copy_n(own, batch.count * joint, s.actions.data());
    std::copy_n(batch.states.data(), batch.count * state, s.states.data());
  } else {
    rows = batch.count * agents;
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
  // The loss is minus the value, the mean over samples.
  critics_.ActionGradient(s.states.data(), s.actions.data(), rows,
                          -1.0F / static_cast<float>(base().batch), false, &s.critics,
                          s.values.data(), s.d_actions.data());
  const float* d_own = s.d_actions.data();
  if (rows != batch.count) {
    for (int r = 0; r < rows; ++r) {
      std::copy_n(s.d_actions.data() + static_cast<std::ptrdiff_t>(r) * joint + (r % agents) * size,
                  size, s.d_own.data() + static_cast<std::ptrdiff_t>(r) * size);
    }
    d_own = s.d_own.data();
  }
  actor_.Backward(actor_parameters_.data(), batch.observations.data(), d_own, batch.count * agents,
                  &s.actor, gradient);
  double sum = 0.0;
  for (int r = 0; r < rows; ++r) sum += static_cast<double>(s.values[static_cast<std::size_t>(r)]);
  return sum / rows * batch.count;
}

void Maddpg::TrainActor(const StepContext& step) {
  std::array<double, SlicedGradient::kSlices> values{};
  actor_gradient_.Compute(0, base().batch, [&](int slice, int, int, int, float* gradient) {
    values[static_cast<std::size_t>(slice)] = AddActorGradient(slice, gradient);
  });
  const Adam adam(base().adam_eps, &actor_adam_);
  actor_norm_ += actor_gradient_.Apply(adam, 0, actor_.parameters(), base().lr * step.rate,
                                       base().grad_clip, actor_parameters_.data());
  for (const double part : values) values_ += part / base().batch;
  ++actor_steps_;
}

void Maddpg::Step(const StepContext& step) {
  rate_ = step.rate;
  squares_ += TrainCritics(step);
  if (step.number % static_cast<std::uint32_t>(own_.policy_delay) != 0) return;
  TrainActor(step);
  critics_.MoveTargets(base().tau);
  MoveTowards(actor_parameters_, base().tau, &actor_target_);
}

UpdateReport Maddpg::Report(int steps) {
  const double critic = std::max(steps, 1), actor = std::max(actor_steps_, 1);
  const Problem& p = problem();
  UpdateReport report;
  report.values = {base().lr * rate_, squares_ / critic,
                   static_cast<double>(scales().reward_std) * (values_ / actor) +
                       static_cast<double>(scales().value_mean),
                   actor_norm_ / actor, critic_norm_ / critic};
  const NetworkSpec& q = critics_.network().spec();
  const double per_critic_step = own_.critics * (q.forward_products() + q.training_products()) +
                                 p.agents * actor_.spec().forward_products();
  const double per_actor_step =
      p.agents * actor_.spec().training_products() +
      2.0 * q.forward_products() * (own_.others == "policy" ? 1 : p.agents);
  report.flops = 2.0 * base().batch * (steps * per_critic_step + actor_steps_ * per_actor_step);
  squares_ = values_ = actor_norm_ = critic_norm_ = 0.0;
  actor_steps_ = 0;
  return report;
}

std::vector<ReportColumn> Maddpg::Columns() const {
  return {{"learning_rate", "", 0},
          {"critic_loss", "TD", 5},
          {"value", "Q", 2},
          {"actor_gradient_norm", "|dA|", 4},
          {"critic_gradient_norm", "", 0}};
}

void Maddpg::Save(Archive* archive) const {
  ReplayLearner::Save(archive);
  critics_.Save(archive);
  archive->Put("actor", actor_parameters_);
  archive->Put("target_actor", actor_target_);
  actor_adam_.Save("actor_adam", archive);
  critic_adam_.Save("critic_adam", archive);
}

void Maddpg::Load(const Archive& archive) {
  const std::vector<float>& actor = archive.Floats("actor", actor_parameters_.size());
  const std::vector<float>& target = archive.Floats("target_actor", actor_target_.size());
  critics_.Load(archive);
  actor_adam_.Load("actor_adam", archive);
  critic_adam_.Load("critic_adam", archive);
  ReplayLearner::Load(archive);
  actor_parameters_ = actor;
  actor_target_ = target;
}

void Maddpg::StartFrom(const Archive& archive) {
  ReplayLearner::StartFrom(archive);
  critics_.Load(archive);
  actor_parameters_ = archive.Floats("actor", actor_parameters_.size());
  actor_target_ = archive.Floats("target_actor", actor_target_.size());
}

std::vector<agent::Policy> Maddpg::Policies(const agent::PolicyMetadata& metadata) const {
  NetworkSpec spec = actor_.spec();
  spec.squash = scales().action;
  std::vector<float> parameters = actor_parameters_;
  // What a graph explores with.
  const double noise = std::max(own_.noise_min, 1e-3) * static_cast<double>(scales().action);
  parameters.insert(parameters.end(), static_cast<std::size_t>(problem().action_size),
                    static_cast<float>(std::log(noise)));
  return {GaussianActor(spec).ToPolicy(parameters.data(), scales().observations, metadata)};
}

}  // namespace stg::learn

#include "marl_trainer/learn/algorithms/off_policy/joint_critics.hpp"

#include <algorithm>

#include "marl_trainer/learn/algorithms/off_policy/replay_learner.hpp"

namespace stg::learn {
namespace {

NetworkSpec CriticSpec(const Problem& problem, const ReplayOptions& options) {
  NetworkSpec spec;
  spec.inputs = problem.state_size + problem.agents * problem.action_size;
  spec.hidden = options.critic_hidden;
  spec.activation = options.activation;
  spec.layer_norm = options.layer_norm;
  spec.output_gain = 0.1F;
  return spec;
}

}  // namespace

JointCritics::JointCritics(const Problem& problem, const ReplayOptions& options, int count,
                           std::uint64_t seed)
    : state_size_(problem.state_size),
      joint_action_(problem.agents * problem.action_size),
      count_(count),
      action_gain_(static_cast<float>(options.action_gain)),
      network_(CriticSpec(problem, options)),
      parameters_(static_cast<std::size_t>(count) * network_.parameters()) {
  for (int k = 0; k < count; ++k) {
    // The actor is network 0.
    InitialiseOrthogonally(
        network_.spec(), seed, static_cast<std::uint32_t>(1 + k),
        parameters_.data() + static_cast<std::size_t>(k) * network_.parameters());
  }
  targets_ = parameters_;
}

JointCritics::Scratch::Scratch(const JointCritics& critics, int rows)
    : inputs_(static_cast<std::size_t>(rows * critics.network_.inputs())),
      workspaces_(static_cast<std::size_t>(critics.count_), Mlp::Workspace(critics.network_, rows)),
      d_output_(static_cast<std::size_t>(rows)),
      d_actions_(static_cast<std::size_t>(rows * critics.joint_action_)) {}

void JointCritics::Fill(const float* states, const float* actions, int rows, Scratch* s) const {
  float* to = s->inputs_.data();
  for (int r = 0; r < rows; ++r) {
    to = std::copy_n(states + static_cast<std::ptrdiff_t>(r) * state_size_, state_size_, to);
    const float* action = actions + static_cast<std::ptrdiff_t>(r) * joint_action_;
    for (int a = 0; a < joint_action_; ++a) *to++ = action_gain_ * action[a];
  }
}

void JointCritics::Evaluate(const std::vector<float>& parameters, int rows, Scratch* s) const {
  for (int k = 0; k < count_; ++k) {
    network_.Forward(critic(parameters, k), s->inputs_.data(), rows,
                     &s->workspaces_[static_cast<std::size_t>(k)]);
  }
}

void JointCritics::Target(const float* states, const float* actions, int rows, Scratch* s,
                          float* values) const {
  Fill(states, actions, rows, s);
  Evaluate(targets_, rows, s);
  std::copy_n(s->workspaces_[0].output(), rows, values);
  for (std::size_t k = 1; k < s->workspaces_.size(); ++k) {
    for (int r = 0; r < rows; ++r) {
      values[r] = std::min(values[r], s->workspaces_[k].output()[r]);
    }
  }
}

double JointCritics::AddGradient(const ReplayBatch& batch, const float* targets, float weight,
                                 Scratch* s, float* gradient) const {
  Fill(batch.states.data(), batch.actions.data(), batch.count, s);
  Evaluate(parameters_, batch.count, s);
  double squares = 0.0;
  for (int k = 0; k < count_; ++k) {
    Mlp::Workspace& workspace = s->workspaces_[static_cast<std::size_t>(k)];
    for (int r = 0; r < batch.count; ++r) {
      const float error = workspace.output()[r] - targets[r];
      squares += static_cast<double>(error) * static_cast<double>(error) / count_;
      s->d_output_[static_cast<std::size_t>(r)] = 2.0F * weight * error;
    }
    network_.Backward(critic(parameters_, k), s->inputs_.data(), s->d_output_.data(), batch.count,
                      &workspace, gradient + static_cast<std::size_t>(k) * network_.parameters());
  }
  return squares;
}

void JointCritics::ActionGradient(const float* states, const float* actions, int rows, float weight,
                                  bool smallest, Scratch* s, float* values,
                                  float* d_actions) const {
  Fill(states, actions, rows, s);
  const int used = smallest ? count_ : 1;
  for (int k = 0; k < used; ++k) {
    network_.Forward(critic(parameters_, k), s->inputs_.data(), rows,
                     &s->workspaces_[static_cast<std::size_t>(k)]);
  }
  const auto value = [&](int k, int r) {
    return s->workspaces_[static_cast<std::size_t>(k)].output()[r];
  };
  for (int r = 0; r < rows; ++r) {
    values[r] = value(0, r);
    for (int k = 1; k < used; ++k) values[r] = std::min(values[r], value(k, r));
  }
  std::fill_n(d_actions, static_cast<std::ptrdiff_t>(rows) * joint_action_, 0.0F);
  for (int k = 0; k < used; ++k) {
    for (int r = 0; r < rows; ++r) {
      // Of equal values only the first counts, so that each row counts once.
      bool chosen = value(k, r) == values[r];
      for (int j = 0; j < k; ++j) chosen = chosen && value(j, r) != values[r];
      s->d_output_[static_cast<std::size_t>(r)] = chosen ? weight : 0.0F;
    }
    network_.InputGradient(critic(parameters_, k), s->d_output_.data(), rows, state_size_,
                           joint_action_, &s->workspaces_[static_cast<std::size_t>(k)],
                           s->d_actions_.data());
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(rows) * joint_action_; ++i) {
      d_actions[i] += action_gain_ * s->d_actions_[static_cast<std::size_t>(i)];
    }
  }
}

void JointCritics::RescaleValues(double ratio, double shift) {
  for (std::vector<float>* all : {&parameters_, &targets_}) {
    for (int k = 0; k < count_; ++k) {
      RescaleOutputs(network_, ratio, shift,
                     all->data() + static_cast<std::size_t>(k) * network_.parameters());
    }
  }
}

void JointCritics::MoveTargets(double tau) { MoveTowards(parameters_, tau, &targets_); }

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/ppo_config.hpp"
#include "marl_trainer/learn/nn/adam.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"

namespace stg::learn {

/// Trained parameters of a network, and the state of their optimiser.
struct Trained {
  explicit Trained(std::vector<float> initial)
      : numbers(std::move(initial)), adam(numbers.size()) {}

  /// Stores them as `name` and `name`_adam.
  void Save(const std::string& name, Archive* archive) const;
  /// Throws UserError if the size differs.
  void Load(const std::string& name, const Archive& archive);

  std::vector<float> numbers;
  AdamState adam;
};

/// Shapes of an actor, with log sigma, and of the critic. The critic maps the true state of the
/// swarm to one value per environment step.
struct ActorCritic {
  ActorCritic(const Problem& problem, const PpoOptions& config);

  GaussianActor actor;
  Mlp critic;

  int action_size() const { return actor.action_size(); }

  /// Replaces the mean of an AUV's action by a draw around it.
  /// @param row row of the AUV in `out`: its environment times `agents` plus its number
  void Explore(const Trained& trained_actor, const DrawKeys& keys, int agents, int row,
               const Actions& out) const;

  /// Initial parameters of the i-th actor of a seed, and of the critic.
  Trained NewActor(std::uint64_t seed, int i, double log_std) const;
  Trained NewCritic(std::uint64_t seed) const;
};

}  // namespace stg::learn

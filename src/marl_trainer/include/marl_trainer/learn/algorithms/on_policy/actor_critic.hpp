#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/ppo_config.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"

namespace stg::learn {

/// The actor that all AUVs share and the central critic, which maps the true state of the swarm to
/// one value per environment step. Parameters in one flat array: actor (with log sigma), critic.
struct ActorCritic {
  ActorCritic(const Problem& problem, const PpoOptions& config);

  GaussianActor actor;
  Mlp critic;

  int action_size() const { return actor.action_size(); }
  std::size_t critic_offset() const { return actor.parameters(); }
  std::size_t parameters() const { return critic_offset() + critic.parameters(); }

  std::vector<float> Initialise(std::uint64_t seed, double log_std) const;
};

}  // namespace stg::learn

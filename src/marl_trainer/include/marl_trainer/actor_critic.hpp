#pragma once

#include <cstdint>
#include <vector>

#include "auv_dynamics/scenario.hpp"
#include "marl_trainer/mlp.hpp"
#include "marl_trainer/normaliser.hpp"
#include "marl_trainer/train_config.hpp"
#include "stg_agent/policy.hpp"

namespace stg {

/// Shapes of the shared actor and the central critic, and the layout of their
/// parameters in one flat array: actor, log sigma, critic.
///
/// The actor maps one AUV's observation to the mean action_scale * tanh(net) of
/// a Gaussian with state-independent sigma (Eq. 37); the critic maps the true
/// state of the swarm to one value per environment step.
struct ActorCritic {
  ActorCritic(const Scenario& scenario, int state_size, const TrainConfig& config);

  Mlp actor, critic;
  float action_scale;

  int action_size() const { return actor.outputs(); }
  std::size_t log_std_offset() const { return actor.parameters(); }
  std::size_t critic_offset() const {
    return log_std_offset() + static_cast<std::size_t>(action_size());
  }
  std::size_t parameters() const { return critic_offset() + critic.parameters(); }

  std::vector<float> Initialise(std::uint64_t seed, double log_std) const;

  /// The policy that `parameters` and the observation normaliser make.
  Policy ToPolicy(const float* parameters, const Normaliser& observations,
                  PolicyMetadata metadata) const;
};

/// mean = scale * tanh(net) in place over count numbers.
void SquashMean(float scale, int count, float* net);

}  // namespace stg

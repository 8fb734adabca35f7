#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/nn/mlp.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"
#include "marl_trainer/learn/train_config.hpp"
#include "marl_trainer/scenario/scenario.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::learn {

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

  /// Turns the kWallUnits units of the actor's first layer that say least into hinges that rise
  /// where the target is closer to a wall than 1/2, 1, 2 and 4 times the margin, and that nothing
  /// listens to yet. On the way to a wall the best action changes within the margin; from inputs
  /// that span the workspace, training finds so sharp a kink late or never.
  /// @param margin_m       of the kink that matters [m]
  /// @param half_extent_m  of the workspace [m]
  /// @param observations   the normaliser that the inputs of the hinges pass
  void PlaceWallUnits(double margin_m, double half_extent_m, const Normaliser& observations,
                      float* parameters) const;
  static constexpr int kWallUnits = 24;  ///< 6 walls, 4 distances

  /// The policy that `parameters` and the observation normaliser make.
  agent::Policy ToPolicy(const float* parameters, const Normaliser& observations,
                         agent::PolicyMetadata metadata) const;
};

/// mean = scale * tanh(net) in place over count numbers.
void SquashMean(float scale, int count, float* net);

}  // namespace stg::learn

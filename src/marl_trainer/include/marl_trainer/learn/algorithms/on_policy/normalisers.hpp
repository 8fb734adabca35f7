#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/actor_critic.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"
#include "marl_trainer/learn/checkpoint/archive.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

/// Means and standard deviations of the inputs and outputs of the networks, fixed for one
/// collection.
struct Scales {
  Normaliser observations, states;
  float value_mean = 0.0F, value_std = 1.0F;
};

/// The running moments from which the scales of inputs and value targets are computed.
class Normalisers {
 public:
  Normalisers(const Problem& problem, const PpoOptions& config);

  const Scales& scales() const { return scales_; }

  /// Adds raw observations and states. Call it after the update on them, because the policy changes
  /// when UpdateInputScales applies them.
  void Add(const RunningMoments& observations, const RunningMoments& states);
  void UpdateInputScales();

  /// Adds value targets, and changes the critic's last layer with the new scale, so that all
  /// predictions stay the same (PopArt, van Hasselt et al. 2016).
  /// @param parameters of the critic.
  void AddTargets(const RunningMoments& targets, const Mlp& critic, float* parameters);

  /// Takes the moments of the observations from a policy file, as if they were from its whole
  /// training.
  void StartFrom(const agent::Policy& policy, int agents);

  void Save(Archive* archive) const;
  /// Throws UserError if a size differs, and leaves this object unchanged.
  void Load(const Archive& archive);

 private:
  const float std_floor_, clip_, std_scale_;
  RunningMoments observations_, states_, values_;
  Scales scales_;
};

}  // namespace stg::learn

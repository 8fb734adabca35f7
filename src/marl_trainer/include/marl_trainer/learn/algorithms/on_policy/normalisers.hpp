#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/actor_critic.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"
#include "marl_trainer/learn/checkpoint/archive.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

/// Means and standard deviation of what the networks see and predict, fixed for
/// one collection.
struct Scales {
  Normaliser observations, states;
  float value_mean = 0.0F, value_std = 1.0F;
};

/// The running moments behind the scales of inputs and value targets.
class Normalisers {
 public:
  Normalisers(const Problem& problem, const PpoOptions& config);

  const Scales& scales() const { return scales_; }

  /// Takes in raw observations and states. Call after the update on them: it changes the policy
  /// once UpdateInputScales applies it.
  void Add(const RunningMoments& observations, const RunningMoments& states);
  void UpdateInputScales();

  /// Takes in value targets and changes the critic's last layer with the scale, so that no
  /// prediction changes (PopArt, van Hasselt et al. 2016).
  /// @param parameters of the critic.
  void AddTargets(const RunningMoments& targets, const Mlp& critic, float* parameters);

  /// Takes the observations' moments of a policy file, as of all that it was trained on.
  void StartFrom(const agent::Policy& policy, int agents);

  void Save(Archive* archive) const;
  /// Throws UserError for another size and leaves this object as it was.
  void Load(const Archive& archive);

 private:
  const float std_floor_, clip_, std_scale_;
  RunningMoments observations_, states_, values_;
  Scales scales_;
};

}  // namespace stg::learn

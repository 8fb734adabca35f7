#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/normalisers.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"

namespace stg::learn {

/// Data that on-policy methods with a central critic collect: rollouts, the normalisers of the
/// networks' inputs, and advantages by the critic.
class ValuedRollouts {
 public:
  /// @param critic must outlive this object.
  ValuedRollouts(const Problem& problem, const PpoOptions& config, const Mlp& critic,
                 const Team& team);

  void Begin(const Collection& collection);
  void Observe(const Transition& transition);

  /// Estimates the advantages, and adapts the scale of the values to their targets.
  /// @param critic parameters of the critic; its last layer changes with the scale.
  /// @return explained variance of the value targets, for the critic that acted
  double Estimate(float* critic);
  /// Adds the collected inputs to the normalisers. Call it after the update on them.
  void UpdateInputScales();

  std::vector<const RolloutBuffer*> buffers() const;
  const Scales& scales() const { return normalisers_.scales(); }
  Normalisers& normalisers() { return normalisers_; }
  const Normalisers& normalisers() const { return normalisers_; }

 private:
  /// Data that one shard collects.
  struct Rollout {
    RolloutBuffer buffer;
    RunningMoments observations, states;  ///< raw
  };

  void EstimateAdvantages(const float* critic, int shard, int worker);
  /// Values, in units of reward, of normalised states [rows, S].
  void EstimateValues(const float* critic, const float* states, int rows, int worker,
                      float* values);

  const Problem problem_;
  const float gamma_, lambda_;
  const int moment_stride_;
  const Mlp& critic_;
  const Team team_;
  Normalisers normalisers_;
  std::vector<Mlp::Workspace> workspaces_;  // by worker
  std::vector<Rollout> rollouts_;
};

}  // namespace stg::learn

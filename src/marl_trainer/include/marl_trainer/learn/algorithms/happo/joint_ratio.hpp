#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/actor_critic.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"
#include "marl_trainer/learn/comm/team.hpp"

namespace stg::learn {

/// The factor M of each sample (Kuba et al. 2022): the ratio new / old of the joint density of the
/// actions of all AUVs that have learned so far.
class JointRatio {
 public:
  /// @param networks must outlive this object.
  JointRatio(const ActorCritic& networks, const Team& team);

  /// Sets the factors of the samples of these rollouts to 1. The rollouts must outlive the use of
  /// this object.
  void Begin(const std::vector<const RolloutBuffer*>& rollouts);
  /// Multiplies the factors by the ratio of an AUV that has learned.
  void Multiply(int auv, const Trained& actor);

  /// Factors in the order of the rollouts.
  const std::vector<double>& factors() const { return factors_; }
  /// Mean |M - 1| over the samples of all ranks.
  double Miss() const;

 private:
  struct Scratch {
    Mlp::Workspace pass;
    std::vector<float> observations;
  };
  /// Part of a rollout that is computed at once. The last digits of a matrix product may depend on
  /// the number of rows, so the blocks are fixed.
  struct Block {
    const RolloutBuffer* rollout;
    int from, to;
    double* factors;
  };
  void MultiplyBlock(const Block& block, int auv, const float* actor, Scratch* scratch);

  const ActorCritic& networks_;
  const Team team_;
  std::vector<Scratch> scratch_;  // by worker
  std::vector<const RolloutBuffer*> rollouts_;
  std::vector<double> factors_;
  std::vector<Block> blocks_;
};

}  // namespace stg::learn

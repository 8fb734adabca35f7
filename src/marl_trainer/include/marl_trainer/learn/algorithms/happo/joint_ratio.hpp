#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/actor_critic.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"
#include "marl_trainer/learn/comm/team.hpp"

namespace stg::learn {

/// The factor M of each sample (Kuba et al. 2022): the ratio of the joint densities, new over old,
/// of the actions taken by the AUVs that have learned so far.
class JointRatio {
 public:
  /// @param networks must outlive this object.
  JointRatio(const ActorCritic& networks, const Team& team);

  /// Of the samples of these rollouts, which must outlive the use of this object: 1.
  void Begin(const std::vector<const RolloutBuffer*>& rollouts);
  /// Multiplies by the ratio of an AUV that has learned.
  void Multiply(int auv, const Trained& actor);

  /// In the order of the rollouts.
  const std::vector<double>& factors() const { return factors_; }
  /// Mean |M - 1| over the samples of all ranks.
  double Miss() const;

 private:
  struct Scratch {
    Mlp::Workspace pass;
    std::vector<float> observations;
  };
  /// The samples of a rollout are computed in blocks: the last digits of a product of matrices may
  /// depend on how many rows there are.
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

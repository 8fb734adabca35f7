#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/off_policy/replay_batch.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"
#include "marl_trainer/learn/nn/mlp.hpp"

namespace stg::learn {

/// One or two networks q(state, actions of all AUVs), and target networks that follow them (Lowe et
/// al. 2017). The smaller of two values avoids overestimation (Fujimoto et al. 2018).
class JointCritics {
 public:
  JointCritics(const Problem& problem, const ReplayOptions& options, int count, std::uint64_t seed);

  /// Memory of one slice.
  class Scratch {
   public:
    Scratch(const JointCritics& critics, int rows);

   private:
    friend class JointCritics;
    std::vector<float> inputs_;                // [rows, state + joint action]
    std::vector<Mlp::Workspace> workspaces_;   // by critic
    std::vector<float> d_output_, d_actions_;  // [rows], [rows, joint action]
  };

  /// Smallest value of the target networks at states [rows, state_size] and joint actions [rows,
  /// A].
  void Target(const float* states, const float* actions, int rows, Scratch* scratch,
              float* values) const;

  /// Adds the gradient of weight * sum (q - target)^2 of every critic to gradient [parameters].
  /// Returns the sum of the squares, as the mean over critics.
  double AddGradient(const ReplayBatch& batch, const float* targets, float weight, Scratch* scratch,
                     float* gradient) const;

  /// Computes the values at joint actions, and d value / d actions [rows, A] times `weight`.
  /// @param smallest use the smallest of all critics in each row; false: use the first critic
  void ActionGradient(const float* states, const float* actions, int rows, float weight,
                      bool smallest, Scratch* scratch, float* values, float* d_actions) const;

  void RescaleValues(double ratio, double shift);
  void MoveTargets(double tau);

  const Mlp& network() const { return network_; }
  int count() const { return count_; }
  std::vector<float>& parameters() { return parameters_; }
  const std::vector<float>& parameters() const { return parameters_; }
  std::vector<float>& targets() { return targets_; }

 private:
  void Fill(const float* states, const float* actions, int rows, Scratch* scratch) const;
  void Evaluate(const std::vector<float>& parameters, int rows, Scratch* scratch) const;
  const float* critic(const std::vector<float>& parameters, int k) const {
    return parameters.data() + static_cast<std::size_t>(k) * network_.parameters();
  }

  const int state_size_, joint_action_, count_;
  const float action_gain_;
  const Mlp network_;
  std::vector<float> parameters_, targets_;  // [count][network parameters]
};

}  // namespace stg::learn

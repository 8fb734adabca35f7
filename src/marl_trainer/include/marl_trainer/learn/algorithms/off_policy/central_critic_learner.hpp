#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/off_policy/joint_critics.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_learner.hpp"
#include "marl_trainer/learn/nn/observed_pass.hpp"

namespace stg::learn {

/// The gradient steps of off-policy methods with an actor that all AUVs share and critics of the
/// state and the joint action. A method defines the targets of the critics and the actor's
/// objective.
class CentralCriticLearner : public ReplayLearner {
 public:
  /// @param critics number of critics
  CentralCriticLearner(const ReplayOptions& options, const NetworkSpec& actor, int critics,
                       const TrainConfig& common, const Problem& problem, const Team& team);

  std::vector<ReportColumn> Columns() const override;
  std::vector<NetworkSize> Sizes() const override;

  const JointCritics& critics() const { return critics_; }

 protected:
  /// Numbers behind a slice's gradient, summed over its samples.
  struct Sums {
    double squares = 0.0;  ///< (q - target)^2
    double value = 0.0;    ///< q of the actor's actions
    double entropy = 0.0;  ///< of each AUV's actions, if the method has an entropy
  };

  /// Adds the critics' gradient of one slice, for the mean over the whole batch. `sums` gets the
  /// squares.
  virtual void AddCriticGradient(const StepContext& step, int slice, float* gradient,
                                 Sums* sums) = 0;
  /// The same for the actor. `sums` gets the rest.
  virtual void AddActorGradient(const StepContext& step, int slice, float* gradient,
                                Sums* sums) = 0;

  /// One gradient step of all critics or of the actor. The actor's step returns means over samples.
  void TrainCritics(const StepContext& step);
  Sums TrainActor(const StepContext& step);

  void RescaleValues(double ratio, double shift) override { critics_.RescaleValues(ratio, shift); }

  /// Multiplications per sample in one step of the critics and in one step of the actor.
  struct Products {
    double critics, actor;
  };
  virtual Products ProductsPerSample() const = 0;

  UpdateReport Report(int steps) override;
  struct Means {
    double learning_rate, critic_loss, value, entropy, actor_norm, critic_norm;
    int actor_steps;
  };
  /// Means over the steps since the last call. The critics made `steps` of them.
  Means TakeMeans(int steps);
  /// Floating-point operations of these numbers of steps.
  double Flops(int critic_steps, int actor_steps) const;

  const Mlp& actor() const { return actor_; }
  std::vector<float>& actor_parameters() { return actor_parameters_; }
  const std::vector<float>& actor_parameters() const { return actor_parameters_; }
  JointCritics& critics() { return critics_; }
  ObservedPass& acting(int worker) { return acting_[static_cast<std::size_t>(worker)]; }

 private:
  const Mlp actor_;
  JointCritics critics_;
  std::vector<float> actor_parameters_;
  AdamState actor_adam_, critic_adam_;
  SlicedGradient actor_gradient_, critic_gradient_;
  std::vector<ObservedPass> acting_;  // by worker
  // Since the last report.
  Sums sums_;
  double actor_norm_ = 0.0, critic_norm_ = 0.0, rate_ = 1.0;
  int actor_steps_ = 0;
};

}  // namespace stg::learn

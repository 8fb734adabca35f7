#pragma once

#include <memory>
#include <vector>

#include "marl_trainer/learn/algorithms/maddpg/maddpg_config.hpp"
#include "marl_trainer/learn/algorithms/off_policy/joint_critics.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_learner.hpp"

namespace stg::learn {

/// MADDPG (Lowe et al. 2017) with an actor that all AUVs share, and by its options MATD3 (Fujimoto
/// et al. 2018, Ackermann et al. 2019): critics of state and joint action, a deterministic actor
/// that climbs the first one's gradient.
class Maddpg : public ReplayLearner {
 public:
  Maddpg(const ReplayOptions& options, const DeterministicOptions& own, const TrainConfig& common,
         const Problem& problem, WorkerPool* pool);
  ~Maddpg() override;

  void Act(const Decision& decision, const Actions& out) override;
  void Save(Archive* archive) const override;
  void Load(const Archive& archive) override;
  void StartFrom(const Archive& archive) override;
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;
  std::vector<ReportColumn> Columns() const override;

  const JointCritics& critics() const { return critics_; }

 protected:
  void Step(const StepContext& step) override;
  void RescaleValues(double ratio, double shift) override { critics_.RescaleValues(ratio, shift); }
  UpdateReport Report(int steps) override;

 private:
  struct Scratch;  // per slice
  struct Acting;   // per worker

  double TrainCritics(const StepContext& step);
  void TrainActor(const StepContext& step);
  double AddCriticGradient(const StepContext& step, int slice, float* gradient);
  double AddActorGradient(int slice, float* gradient);

  const DeterministicOptions own_;
  const Mlp actor_;  // actions in +-1
  JointCritics critics_;
  std::vector<float> actor_parameters_, actor_target_;
  AdamState actor_adam_, critic_adam_;
  SlicedGradient actor_gradient_, critic_gradient_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  std::vector<std::unique_ptr<Acting>> acting_;
  // Since the last report.
  double squares_ = 0.0, values_ = 0.0, actor_norm_ = 0.0, critic_norm_ = 0.0;
  int actor_steps_ = 0;
  double rate_ = 1.0;
};

}  // namespace stg::learn

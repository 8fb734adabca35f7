#pragma once

#include <memory>
#include <vector>

#include "marl_trainer/learn/algorithms/masac/masac_config.hpp"
#include "marl_trainer/learn/algorithms/masac/squashed_gaussian.hpp"
#include "marl_trainer/learn/algorithms/off_policy/joint_critics.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_learner.hpp"

namespace stg::learn {

/// MASAC: soft actor-critic (Haarnoja et al. 2018) with two critics of state and joint action, an
/// actor that all AUVs share, and an entropy weight that is learned for each AUV's entropy.
class Masac : public ReplayLearner {
 public:
  Masac(const ReplayOptions& options, const SoftOptions& own, const TrainConfig& common,
        const Problem& problem, WorkerPool* pool);
  ~Masac() override;

  void Act(const Decision& decision, const Actions& out) override;
  void Save(Archive* archive) const override;
  void Load(const Archive& archive) override;
  void StartFrom(const Archive& archive) override;
  /// The mean before the squash, squashed.
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;
  std::vector<ReportColumn> Columns() const override;

  double alpha() const;

 protected:
  void Step(const StepContext& step) override;
  void RescaleValues(double ratio, double shift) override;
  UpdateReport Report(int steps) override;

 private:
  struct Scratch;  // per slice
  struct Acting;   // per worker

  /// What the actor does on observations [rows] with fresh draws, into the scratch memory.
  void Sample(const float* observations, int rows, const StepContext& step, int purpose, int slice);
  double AddCriticGradient(const StepContext& step, int slice, float* gradient);
  void AddActorGradient(const StepContext& step, int slice, float* gradient);
  void TrainActor(const StepContext& step);

  const SoftOptions own_;
  const LogStdRange range_;
  const Mlp actor_;  // mean and spread, before the squash
  JointCritics critics_;
  std::vector<float> actor_parameters_;
  std::vector<float> log_alpha_;  // one number
  AdamState actor_adam_, critic_adam_, alpha_adam_;
  SlicedGradient actor_gradient_, critic_gradient_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  std::vector<std::unique_ptr<Acting>> acting_;
  // Since the last report.
  double squares_ = 0.0, values_ = 0.0, entropy_ = 0.0, actor_norm_ = 0.0, critic_norm_ = 0.0;
  double rate_ = 1.0;
};

}  // namespace stg::learn

#pragma once

#include <memory>
#include <vector>

#include "marl_trainer/learn/algorithms/masac/masac_config.hpp"
#include "marl_trainer/learn/algorithms/masac/squashed_gaussian.hpp"
#include "marl_trainer/learn/algorithms/off_policy/central_critic_learner.hpp"

namespace stg::learn {

/// MASAC: soft actor-critic (Haarnoja et al. 2018) with two critics of the state and the joint
/// action, and one actor that all AUVs share. The weight of the entropy is learned, for a target
/// entropy of each AUV.
class Masac : public CentralCriticLearner {
 public:
  Masac(const ReplayOptions& options, const SoftOptions& own, const TrainConfig& common,
        const Problem& problem, const Team& team);
  ~Masac() override;

  void Act(const Decision& decision, const Actions& out) override;
  /// The policy is the squashed mean.
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;
  std::vector<ReportColumn> Columns() const override;
  std::vector<NetworkSize> Sizes() const override;

  double alpha() const;

 protected:
  void Step(const StepContext& step) override;
  void AddCriticGradient(const StepContext& step, int slice, float* gradient, Sums* sums) override;
  void AddActorGradient(const StepContext& step, int slice, float* gradient, Sums* sums) override;
  Products ProductsPerSample() const override;
  UpdateReport Report(int steps) override;

 private:
  struct Scratch;  // per slice

  /// Draws the actor's actions on observations [rows] into the scratch memory.
  void Sample(const float* observations, int rows, const StepContext& step, int purpose, int slice);

  const SoftOptions own_;
  const LogStdRange range_;
  std::vector<float> log_alpha_;  // one number
  AdamState alpha_adam_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  std::vector<std::vector<float>> noise_;  // by worker, for one AUV's action
};

}  // namespace stg::learn

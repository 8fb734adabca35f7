#pragma once

#include <memory>
#include <vector>

#include "marl_trainer/learn/algorithms/maddpg/maddpg_config.hpp"
#include "marl_trainer/learn/algorithms/off_policy/central_critic_learner.hpp"

namespace stg::learn {

/// MADDPG (Lowe et al. 2017) with an actor that all AUVs share. With other options it is MATD3
/// (Fujimoto et al. 2018, Ackermann et al. 2019). It has critics of the state and the joint action,
/// and a deterministic actor that follows the gradient of the first critic.
class Maddpg : public CentralCriticLearner {
 public:
  Maddpg(const ReplayOptions& options, const DeterministicOptions& own, const TrainConfig& common,
         const Problem& problem, const Team& team);
  ~Maddpg() override;

  void Act(const Decision& decision, const Actions& out) override;
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;

 protected:
  void Step(const StepContext& step) override;
  void AddCriticGradient(const StepContext& step, int slice, float* gradient, Sums* sums) override;
  void AddActorGradient(const StepContext& step, int slice, float* gradient, Sums* sums) override;
  Products ProductsPerSample() const override;

 private:
  struct Scratch;  // per slice

  const DeterministicOptions own_;
  /// In the actor's loss the other AUVs act by the present policy; false: they take their recorded
  /// actions.
  const bool others_act_now_;
  std::vector<float> actor_target_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
};

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/happo/happo_config.hpp"
#include "marl_trainer/learn/algorithms/happo/joint_ratio.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_update.hpp"
#include "marl_trainer/learn/algorithms/on_policy/valued_rollouts.hpp"
#include "marl_trainer/learn/nn/observed_pass.hpp"

namespace stg::learn {

/// HAPPO (Kuba et al. 2022, "Trust region policy optimisation in multi-agent reinforcement
/// learning"): one actor for each AUV, and one value of the swarm's true state. The actors learn
/// one after the other, in a new random order each time. The loss of an actor has the advantage
/// times the joint probability ratio of the actors before it. The critic learns last.
class Happo : public Algorithm {
 public:
  Happo(const HappoConfig& config, const TrainConfig& common, const Problem& problem,
        const Team& team);

  void Begin(const Collection& collection) override;
  void Act(const Decision& decision, const Actions& out) override;
  void Observe(const Transition& transition) override { rollouts_.Observe(transition); }
  UpdateReport Update(const UpdateContext& context) override;

  void Save(Archive* archive) const override;
  void Load(const Archive& archive) override;
  void StartFrom(const Archive& archive) override;

  /// One policy for each AUV.
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;
  std::vector<ReportColumn> Columns() const override;
  std::vector<NetworkSize> Sizes() const override;

  const ActorCritic& networks() const { return networks_; }
  const std::vector<Trained>& actors() const { return actors_; }
  const Trained& critic() const { return critic_; }
  const ValuedRollouts& rollouts() const { return rollouts_; }
  /// The ratio after the last AUV of the last update.
  const JointRatio& ratio() const { return ratio_; }
  /// The AUVs in the order of the last update.
  const std::vector<int>& order() const { return order_; }

 private:
  void DrawOrder();

  const HappoConfig config_;
  const std::uint64_t seed_;
  const int agents_;
  const ActorCritic networks_;
  std::vector<Trained> actors_;  // by AUV
  Trained critic_;
  PpoUpdate update_;
  JointRatio ratio_;
  ValuedRollouts rollouts_;
  std::vector<ObservedPass> acting_;     // by worker
  std::vector<std::vector<float>> own_;  // by worker: one AUV's observations in all environments
  std::vector<int> order_;
  std::uint32_t collection_ = 0;
};

}  // namespace stg::learn

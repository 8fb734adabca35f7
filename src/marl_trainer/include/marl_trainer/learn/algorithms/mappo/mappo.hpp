#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_update.hpp"
#include "marl_trainer/learn/algorithms/on_policy/valued_rollouts.hpp"
#include "marl_trainer/learn/nn/observed_pass.hpp"

namespace stg::learn {

/// MAPPO (Eqs. 37-44): clipped probability ratio, one actor that all AUVs share, and one value of
/// the swarm's true state per environment step.
class Mappo : public Algorithm {
 public:
  Mappo(const MappoConfig& config, const TrainConfig& common, const Problem& problem,
        const Team& team);

  void Begin(const Collection& collection) override;
  void Act(const Decision& decision, const Actions& out) override;
  void Observe(const Transition& transition) override { rollouts_.Observe(transition); }
  UpdateReport Update(const UpdateContext& context) override;

  void Save(Archive* archive) const override;
  void Load(const Archive& archive) override;
  void StartFrom(const Archive& archive) override;
  /// The critic stays untrained.
  void StartFrom(const agent::Policy& policy) override;

  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;
  std::vector<ReportColumn> Columns() const override { return PpoColumns(); }
  std::vector<NetworkSize> Sizes() const override;

  const ActorCritic& networks() const { return networks_; }
  const Trained& actor() const { return actor_; }
  const Trained& critic() const { return critic_; }
  const Scales& scales() const { return rollouts_.scales(); }

 private:
  const double wall_units_;
  const Problem problem_;
  const ActorCritic networks_;
  Trained actor_, critic_;
  PpoUpdate update_;
  ValuedRollouts rollouts_;
  std::vector<ObservedPass> acting_;  // by worker
  std::uint32_t collection_ = 0;
};

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_update.hpp"
#include "marl_trainer/learn/algorithms/on_policy/valued_rollouts.hpp"
#include "marl_trainer/learn/nn/observed_pass.hpp"

namespace stg::learn {

/// MAPPO (Eqs. 37-44): the clipped ratio of an actor that all AUVs share, and one value of the
/// swarm's true state per environment step.
class Mappo : public Algorithm {
 public:
  Mappo(const MappoConfig& config, const TrainConfig& common, const Problem& problem,
        WorkerPool* pool);

  void Join(Communicator* ranks) override;
  void Begin(const Collection& collection) override;
  void Act(const Decision& decision, const Actions& out) override;
  void Observe(const Transition& transition) override;
  UpdateReport Update(const UpdateContext& context) override;

  void Save(Archive* archive) const override;
  void Load(const Archive& archive) override;
  void StartFrom(const Archive& archive) override;
  void StartFrom(const agent::Policy& policy) override;

  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;
  std::vector<ReportColumn> Columns() const override { return PpoColumns(); }
  std::vector<NetworkSize> Sizes() const override;

  const ActorCritic& networks() const { return networks_; }
  const std::vector<float>& parameters() const { return parameters_; }
  const Scales& scales() const { return rollouts_.scales(); }

 private:
  const MappoConfig config_;
  const Problem problem_;
  const std::uint64_t seed_;
  const ActorCritic networks_;
  PpoUpdate update_;
  ValuedRollouts rollouts_;
  std::vector<float> parameters_;
  AdamState adam_;
  std::vector<ObservedPass> acting_;  // by worker
  std::uint32_t collection_ = 0;
};

}  // namespace stg::learn

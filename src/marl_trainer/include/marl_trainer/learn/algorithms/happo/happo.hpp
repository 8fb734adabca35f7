#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/happo/happo_update.hpp"
#include "marl_trainer/learn/algorithms/on_policy/valued_rollouts.hpp"
#include "marl_trainer/learn/nn/observed_pass.hpp"

namespace stg::learn {

/// HAPPO (Kuba et al. 2022, "Trust region policy optimisation in multi-agent reinforcement
/// learning"): an actor for each AUV, updated one after the other, and one value of the swarm's
/// true state.
class Happo : public Algorithm {
 public:
  Happo(const HappoConfig& config, const TrainConfig& common, const Problem& problem,
        WorkerPool* pool);

  void Join(Communicator* ranks) override;
  void Begin(const Collection& collection) override;
  void Act(const Decision& decision, const Actions& out) override;
  void Observe(const Transition& transition) override { rollouts_.Observe(transition); }
  UpdateReport Update(const UpdateContext& context) override;

  void Save(Archive* archive) const override;
  void Load(const Archive& archive) override;
  void StartFrom(const Archive& archive) override;

  /// One for each AUV.
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;
  std::vector<ReportColumn> Columns() const override;
  std::vector<NetworkSize> Sizes() const override;

  const ActorCritic& networks() const { return networks_; }
  const HappoParameters& parameters() const { return parameters_; }
  const ValuedRollouts& rollouts() const { return rollouts_; }
  const HappoUpdate& update() const { return update_; }

 private:
  const HappoConfig config_;
  const Problem problem_;
  const ActorCritic networks_;
  HappoUpdate update_;
  ValuedRollouts rollouts_;
  HappoParameters parameters_;
  std::vector<ObservedPass> acting_;     // by worker
  std::vector<std::vector<float>> own_;  // by worker: one AUV's observations in all environments
  std::uint32_t collection_ = 0;
};

}  // namespace stg::learn

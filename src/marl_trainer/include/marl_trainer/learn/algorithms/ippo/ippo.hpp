#pragma once

#include <memory>
#include <vector>

#include "marl_trainer/learn/algorithms/ippo/ippo_config.hpp"
#include "marl_trainer/learn/algorithms/mappo/mappo.hpp"

namespace stg::learn {

/// Independent PPO (de Witt et al. 2020) with shared parameters: every AUV learns from the team's
/// reward, with a value of its own observation. It is computed as MAPPO in which each AUV is a
/// swarm of one, and the state of this swarm is the AUV's observation.
class Ippo : public Algorithm {
 public:
  Ippo(const IppoConfig& config, const TrainConfig& common, const Problem& problem,
       const Team& team);

  void Begin(const Collection& collection) override;
  void Act(const Decision& decision, const Actions& out) override;
  void Observe(const Transition& transition) override;
  UpdateReport Update(const UpdateContext& context) override { return single_.Update(context); }

  void Save(Archive* archive) const override { single_.Save(archive); }
  void Load(const Archive& archive) override { single_.Load(archive); }
  void StartFrom(const Archive& archive) override { single_.StartFrom(archive); }
  void StartFrom(const agent::Policy& policy) override { single_.StartFrom(policy); }

  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override {
    return single_.Policies(metadata);
  }
  std::vector<ReportColumn> Columns() const override { return single_.Columns(); }
  std::vector<NetworkSize> Sizes() const override { return single_.Sizes(); }

 private:
  /// Data of an environment's whole swarm, repeated for each AUV.
  struct RowValues {
    std::vector<float> rewards;           ///< [envs, agents]
    std::vector<std::uint8_t> truncated;  ///< [envs, agents]
  };

  const int agents_;
  Mappo single_;
  std::vector<RowValues> row_values_;  // by shard
};

}  // namespace stg::learn

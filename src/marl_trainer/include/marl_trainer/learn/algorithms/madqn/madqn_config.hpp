#pragma once

#include <memory>
#include <string>

#include "marl_trainer/learn/algorithms/off_policy/exploration_ramp.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"

namespace stg::learn {

/// The choices that have a value: each bin of each dimension, each combination of all dimensions,
/// or each combination of three dimensions (the other three repeat them).
enum class QHeads { kSeparate, kJoint, kBook };
/// Reward that an AUV learns from.
enum class QReward { kTeam, kOwn };

/// Options that only MADQN has.
struct QOptions {
  int bins = 5;
  double bin_power = 1.0;
  QHeads heads = QHeads::kSeparate;
  ExplorationRamp epsilon{0.02, 0.5};  ///< share of random choices
  QReward reward = QReward::kTeam;
};

/// Configuration of MADQN.
struct MadqnConfig : CopyableConfig<MadqnConfig, ReplayConfig>, QOptions {
  void Describe(config::Table* table) override;
  void ApplyPreset(const std::string& preset, TrainConfig* common) override;
  void ValidateOrThrow(const TrainConfig& common) const override;
  bool ReadsState() const override { return false; }
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  const Team& team) const override;
};

}  // namespace stg::learn

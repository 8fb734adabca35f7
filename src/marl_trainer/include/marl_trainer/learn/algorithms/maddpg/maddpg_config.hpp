#pragma once

#include <memory>
#include <string>

#include "marl_trainer/learn/algorithms/off_policy/exploration_ramp.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"

namespace stg::learn {

/// Actions of the other AUVs in the actor's loss: their recorded actions, or the actions of the
/// present policy.
enum class OthersAct { kThen, kNow };

/// Options of methods with a deterministic actor.
struct DeterministicOptions {
  ExplorationRamp noise{0.02, 0.2};  ///< standard deviation as a share of the action's scale
  OthersAct others = OthersAct::kNow;
  int critics = 1;
  int policy_delay = 1;
  double target_noise = 0.0, target_noise_clip = 0.5;
};

/// Configuration of MADDPG.
struct MaddpgConfig : CopyableConfig<MaddpgConfig, ReplayConfig>, DeterministicOptions {
  void Describe(config::Table* table) override;
  void ApplyPreset(const std::string& preset, TrainConfig* common) override;
  void ValidateOrThrow(const TrainConfig& common) const override;
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  const Team& team) const override;
};

}  // namespace stg::learn

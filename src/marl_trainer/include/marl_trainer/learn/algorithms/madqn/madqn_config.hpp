#pragma once

#include <memory>
#include <string>

#include "marl_trainer/learn/algorithms/off_policy/exploration_ramp.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"

namespace stg::learn {

/// Options of MADQN's own.
struct QOptions {
  int bins = 5;
  double bin_power = 1.0;
  std::string heads = "separate";
  ExplorationRamp epsilon{0.02, 0.5};  ///< share of random choices
  std::string reward = "team";
};

/// Configuration of MADQN.
struct MadqnConfig : CopyableConfig<MadqnConfig, ReplayConfig>, QOptions {
  void Describe(OptionTable* table) override;
  void ApplyPreset(const std::string& preset, TrainConfig* common) override;
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  const Team& team) const override;
};

}  // namespace stg::learn

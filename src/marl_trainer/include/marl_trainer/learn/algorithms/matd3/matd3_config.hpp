#pragma once

#include <memory>
#include <string>

#include "marl_trainer/learn/algorithms/maddpg/maddpg_config.hpp"

namespace stg::learn {

/// Configuration of MATD3: MADDPG with the smaller of two critics, targets that are smoothed by
/// noise, and an actor that learns in every second step (Fujimoto et al. 2018).
struct Matd3Config : CopyableConfig<Matd3Config, MaddpgConfig> {
  Matd3Config();
  void Describe(config::Table* table) override;
  void ApplyPreset(const std::string& preset, TrainConfig* common) override;
};

}  // namespace stg::learn

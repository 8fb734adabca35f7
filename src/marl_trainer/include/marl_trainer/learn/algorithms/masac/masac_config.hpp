#pragma once

#include <memory>
#include <string>

#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"

namespace stg::learn {

/// Options that only MASAC has.
struct SoftOptions {
  double initial_alpha = 0.002;
  double alpha_lr = 1e-3;
  double target_entropy = -1.5;
  double min_log_std = -5.0, max_log_std = 1.0;
};

/// Configuration of MASAC.
struct MasacConfig : CopyableConfig<MasacConfig, ReplayConfig>, SoftOptions {
  void Describe(config::Table* table) override;
  void ApplyPreset(const std::string& preset, TrainConfig* common) override;
  void ValidateOrThrow(const TrainConfig& common) const override;
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  const Team& team) const override;
};

}  // namespace stg::learn

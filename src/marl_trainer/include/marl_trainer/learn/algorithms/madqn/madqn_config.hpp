#pragma once

#include <memory>
#include <string>

#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"

namespace stg::learn {

/// Options of MADQN's own.
struct QOptions {
  int bins = 5;
  double bin_power = 1.0;
  std::string heads = "separate";
  double epsilon_min = 0.02, epsilon_max = 0.5;
};

/// Configuration of MADQN.
struct MadqnConfig : ReplayConfig, QOptions {
  std::unique_ptr<AlgorithmConfig> Clone() const override;
  void Describe(OptionTable* table) override;
  void ApplyPreset(const std::string& preset, TrainConfig* common) override;
  void ValidateOrThrow(const TrainConfig& common) const override;
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  WorkerPool* pool) const override;
};

}  // namespace stg::learn

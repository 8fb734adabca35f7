#pragma once

#include <memory>

#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"

namespace stg::learn {

/// Configuration of HAPPO: MAPPO's options and presets, and how the actors take their turns.
struct HappoConfig : MappoConfig {
  bool sequential = true;

  std::unique_ptr<AlgorithmConfig> Clone() const override;
  void Describe(OptionTable* table) override;
  void ValidateOrThrow(const TrainConfig& common) const override;
  void ApplyRecordings(const TrainConfig& common) override;
  void FitPolicy(const agent::Policy& policy) override;
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  WorkerPool* pool) const override;
};

}  // namespace stg::learn

#pragma once

#include <memory>

#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"

namespace stg::learn {

/// Configuration of HAPPO: MAPPO's options and presets, and how the actors take their turns.
struct HappoConfig : CopyableConfig<HappoConfig, MappoConfig> {
  bool sequential = true;

  void Describe(OptionTable* table) override;
  void ApplyRecordings(const TrainConfig& common) override;
  void FitPolicy(const agent::Policy& policy) override;
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  WorkerPool* pool) const override;
};

}  // namespace stg::learn

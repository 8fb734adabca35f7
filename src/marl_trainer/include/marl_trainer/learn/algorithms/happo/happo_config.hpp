#pragma once

#include <memory>

#include "marl_trainer/learn/algorithms/on_policy/ppo_config.hpp"

namespace stg::learn {

/// Configuration of HAPPO: the options and presets of all on-policy methods, and how the actors
/// take turns.
struct HappoConfig : CopyableConfig<HappoConfig, PpoConfig> {
  bool sequential = true;

  void Describe(config::Table* table) override;
  void ApplyRecordings(const TrainConfig& common) override;
  void FitPolicy(const agent::Policy& policy) override;
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  const Team& team) const override;
};

}  // namespace stg::learn

#pragma once

#include <memory>

#include "marl_trainer/learn/algorithms/on_policy/ppo_config.hpp"

namespace stg::learn {

/// Configuration of MAPPO.
struct MappoConfig : CopyableConfig<MappoConfig, PpoConfig> {
  double wall_units = 0.0;  ///< margin [m] of PlaceWallUnits; 0: none

  void Describe(config::Table* table) override;
  void ValidateOrThrow(const TrainConfig& common) const override;
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  const Team& team) const override;
};

}  // namespace stg::learn

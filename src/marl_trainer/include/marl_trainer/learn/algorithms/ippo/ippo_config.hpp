#pragma once

#include <memory>

#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"

namespace stg::learn {

/// Configuration of IPPO: MAPPO's options and presets. The options of the critic apply to the value
/// of an AUV's own observation.
struct IppoConfig : CopyableConfig<IppoConfig, MappoConfig> {
  void ApplyRecordings(const TrainConfig& common) override;
  bool ReadsState() const override { return false; }
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  const Team& team) const override;
};

}  // namespace stg::learn

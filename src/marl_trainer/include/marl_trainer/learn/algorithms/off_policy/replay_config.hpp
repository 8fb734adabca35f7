#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/algorithm_config.hpp"
#include "marl_trainer/learn/nn/network_spec.hpp"

namespace stg::learn {

/// Options that all off-policy methods have.
struct ReplayOptions {
  std::int64_t replay = 100000;
  std::int64_t warmup = 10000;
  int batch = 512;
  double replayed = 4.0;
  int n_step = 3;
  double gamma = 0.9;
  double tau = 0.02;
  std::vector<int> actor_hidden{64, 64};
  std::vector<int> critic_hidden{128, 128};
  HiddenActivation activation = HiddenActivation::kRelu;
  bool layer_norm = true;
  double action_gain = 4.0;
  double lr = 3e-3;
  double critic_lr = 3e-3;
  double lr_final = 0.1;
  double adam_eps = 1e-5;
  double grad_clip = 10.0;
  double observation_clip = 10.0;
  double std_floor = 0.01;
};

/// Configuration of off-policy methods, with their presets: `fast` (ours) and `paper` (values of
/// Table S2 where it has them).
struct ReplayConfig : AlgorithmConfig, ReplayOptions {
  void Describe(config::Table* table) override;
  /// Adds the options of critics of the state and the joint action.
  void DescribeCritics(config::Table* table);
  /// Applies the common part of `fast` and `paper`.
  void ApplyPreset(const std::string& preset, TrainConfig* common) override;
  void ValidateOrThrow(const TrainConfig& common) const override;
  int MostRanks() const override { return kGroups; }
};

}  // namespace stg::learn

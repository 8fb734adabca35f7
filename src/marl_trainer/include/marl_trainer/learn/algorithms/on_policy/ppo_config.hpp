#pragma once

#include <limits>
#include <string>
#include <vector>

#include "marl_trainer/learn/algorithm_config.hpp"
#include "marl_trainer/learn/collect/imitation.hpp"
#include "marl_trainer/learn/nn/network_spec.hpp"

namespace stg::learn {

/// Options that all on-policy methods have.
struct PpoOptions {
  int epochs = 1;
  int minibatch = 400;
  std::vector<int> actor_hidden{64, 64};
  std::vector<int> critic_hidden{64, 64};
  HiddenActivation activation = HiddenActivation::kTanh;
  double lr = 5e-3;
  double critic_lr = 5e-3;
  double lr_final = 0.1;
  double adam_eps = 1e-5;
  double gamma = 0.9;
  double lambda = 0.95;
  double clip = 0.2;
  double entropy = 0.0;
  double value_weight = 0.5;
  double grad_clip = 5.0;
  double target_kl = 0.0;
  double initial_log_std = -1.0;
  double min_log_std = -4.0;
  double max_log_std = 0.0;
  double observation_clip = 10.0;
  double std_floor = 0.01;
  double std_scale = 1.0;
  ImitationConfig imitation;
  /// The normalisers use every n-th decision. This is no option of the command line.
  int moment_stride = 4;
};

/// Configuration of on-policy methods, with their presets: `fast` (ours) and `paper` (Table S2).
struct PpoConfig : AlgorithmConfig, PpoOptions {
  void Describe(config::Table* table) override;
  void ApplyPreset(const std::string& preset, TrainConfig* common) override;
  void ValidateOrThrow(const TrainConfig& common) const override;
  void ApplyRecordings(const TrainConfig& common) override;
  void FitPolicy(const agent::Policy& policy) override;
  const ImitationConfig* Imitation() const override { return &imitation; }
  int MostRanks() const override { return std::numeric_limits<int>::max(); }
};

}  // namespace stg::learn

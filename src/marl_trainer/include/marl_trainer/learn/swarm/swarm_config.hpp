#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "auv_common/config/field.hpp"
#include "stg_agent/entities/entity_policy.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::learn {

/// Hyperparameters of learning with swarms of any size (docs/training.md). A policy step is a
/// command, which lasts 5 s.
struct SwarmConfig {
  std::uint64_t seed = 0;
  std::int64_t steps = 6'000'000;  ///< decisions of a swarm, 1 s each in the field
  agent::EntityAction action = agent::EntityAction::kLaw5;
  agent::EntityNetwork network = agent::EntityNetwork::kPool;
  std::string without = "nothing";  ///< what the actor cannot see (Blinded)
  bool free_assignment = false;     ///< some waters have targets that the AUVs choose freely

  int envs = 128;
  int horizon = 40;         ///< policy steps of one collection
  int segment = 20;         ///< collections until all environments start anew
  int episode_steps = 960;  ///< decisions of a training episode
  double gamma = 0.9835;    ///< per policy step: 300 s
  double lambda = 0.95;
  double own_reward = 0.7;  ///< share of the AUV's own reward; the rest is the mean of its team
  /// Reward of a decision inside the band, beside the scenario's. Of targets that are chosen freely
  /// it is divided among more than two AUVs, and all get as much for the share of targets that have
  /// two.
  double band = 1.0;
  double shaping = 1.0;  ///< weight of gamma Phi(s') - Phi(s), Phi = -|d - d*| / 100 m

  int epochs = 3;
  int minibatch = 7000;  ///< rows of AUVs
  double learning_rate = 5e-4, last_learning_rate = 5e-5;
  double clip = 0.2, target_kl = 0.02, gradient_norm = 0.5, adam_eps = 1e-5;
  double log_std = -1.0, least_log_std = -3.0, most_log_std = -0.5;
  double entropy = 0.01, last_entropy = 0.001;  ///< weight of the choices' entropy
  double value_memory = 500'000;                ///< rows that the moments of the returns remember

  int validation_interval = 2;  ///< segments
  int validation_episodes = 32;
  std::uint64_t validation_seed = 900'000;

  /// The options of a training with swarms: command line and config.json read this one table.
  void Describe(config::Table* table);
  /// Throws UserError that names the option.
  void ValidateOrThrow() const;
};

/// One kind of waters in the mixture that a training flies.
struct SwarmTask {
  std::string name;
  Scenario scenario;
};

/// The mixture of the field for `count` shards: sizes of 1 to 8 AUVs, one or two targets, stresses,
/// search and hunt, and the reward of training in place of the scenario's. Throws UserError for
/// options that do not fit.
/// @param folder of the shipped scenarios
std::vector<SwarmTask> FieldMixture(const std::string& folder, const std::string& scenario,
                                    const SwarmConfig& config, int count);
/// What a training is validated in: the scenario itself and the stresses, unchanged.
std::vector<SwarmTask> FieldValidation(const std::string& folder, const std::string& scenario);

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "auv_common/config/field.hpp"
#include "marl_trainer/learn/collect/imitation.hpp"
#include "stg_agent/entities/entity_policy.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::learn {

/// Hyperparameters of learning with swarms of any size (docs/entities.md). A policy step is one
/// command. It lasts 5 s, or one decision if that is longer; with the action velocity3 it lasts one
/// decision. The defaults are for open water.
struct SwarmConfig {
  std::uint64_t seed = 0;
  std::int64_t steps = 2'048'000;  ///< decisions of a swarm; each lasts 1 s in the field
  agent::EntityAction action = agent::EntityAction::kLaw5;
  agent::EntityNetwork network = agent::EntityNetwork::kPool;
  std::string without = "nothing";  ///< input that the actor cannot use (Blinded)
  /// The actor sees its last command. Correlated noise is in that command, so an actor that sees it
  /// learns to correct the noise, which a deterministic policy does not have.
  bool last_command = false;
  bool free_assignment = false;  ///< some scenarios have targets that the AUVs choose freely
  bool leaving = true;           ///< in some scenarios AUVs leave and join
  /// Kinds of waters in place of the mixture of the field, "name:condition:AUVs:targets" with
  /// commas between them; what is left out is the scenario's own. Empty: the mixture.
  std::string waters;

  int envs = 128;
  int horizon = 40;         ///< policy steps of one collection
  int segment = 20;         ///< number of collections until all environments restart
  int episode_steps = 960;  ///< decisions of a training episode
  double gamma = 0.9835;    ///< per policy step; this is a time of 300 s
  double lambda = 0.95;
  double own_reward = 0.7;  ///< share of the AUV's own reward; the rest is the mean over its team
  /// Reward of a decision inside the band, in addition to the scenario's reward. If targets are
  /// chosen freely, more than two AUVs in a band share the reward of two, and all AUVs also get
  /// this reward times the share of targets that two AUVs cover.
  double band = 1.0;
  double shaping = 1.0;  ///< weight of gamma Phi(s') - Phi(s), Phi = -|d - d*| / 100 m

  int epochs = 3;
  int minibatch = 7000;  ///< in rows of AUVs
  double learning_rate = 5e-4, last_learning_rate = 5e-5;
  double critic_learning_rate = 0.0;  ///< constant; 0: the critic learns at the actor's rate
  double clip = 0.2, target_kl = 0.02, gradient_norm = 0.5, adam_eps = 1e-5;
  double log_std = -2.0, least_log_std = -3.0, most_log_std = -1.5;
  double noise_time_s = 60.0;  ///< correlation time of the exploration; 0: white noise
  double average = 20.0;       ///< updates over which the policy's parameters are averaged
  double entropy = 0.01, last_entropy = 0.001;  ///< weight of the entropy of the choices
  double value_memory = 500'000;  ///< number of rows that the moments of the returns remember

  ImitationConfig imitation;  ///< only with the action velocity3

  int validation_interval = 2;  ///< segments
  int validation_episodes = 32;
  std::uint64_t validation_seed = 900'000;

  /// The options of a training with swarms. The command line and config.json read this table.
  void Describe(config::Table* table);
  /// Throws UserError that names the option.
  void ValidateOrThrow() const;
};

/// One scenario in the mixture that a training flies.
struct SwarmTask {
  std::string name;
  Scenario scenario;
};

/// The mixture between walls for `count` shards: the scenarios in turn, 2 to 8 AUVs, and stress
/// conditions, more than half of them with poor links. Reward and separation are those with which
/// the shipped policies were trained. Throws UserError for a scenario in open water.
/// @param overrides as of FieldMixture
std::vector<SwarmTask> WallsMixture(const std::string& folder,
                                    const std::vector<std::string>& scenarios,
                                    const SwarmConfig& config, int count,
                                    const std::vector<std::string>& overrides = {});
/// Tasks of the validation: the scenarios, nominal and under combined stress. Only the overrides
/// change them.
std::vector<SwarmTask> WallsValidation(const std::string& folder,
                                       const std::vector<std::string>& scenarios,
                                       const std::vector<std::string>& overrides = {});

/// Those of the scenario overrides "key=value" whose keys the others do not set.
std::vector<std::string> NotSetBy(const std::vector<std::string>& others,
                                  const std::vector<std::string>& overrides);

/// The mixture of the field for `count` shards: 1 to 8 AUVs, one or two targets, stress conditions,
/// search and hunt. The reward of the training replaces the scenario's. Throws UserError for
/// options that do not fit. With `config.waters` these take the places of the mixture in turn.
/// @param folder folder of the shipped scenarios
/// @param overrides scenario overrides "key=value" of every kind of waters; they replace the
/// reward of the training, too
std::vector<SwarmTask> FieldMixture(const std::string& folder, const std::string& scenario,
                                    const SwarmConfig& config, int count,
                                    const std::vector<std::string>& overrides = {});
/// Tasks of the validation: the scenario itself and its stress conditions, or `config.waters`. Only
/// the overrides change them.
std::vector<SwarmTask> FieldValidation(const std::string& folder, const std::string& scenario,
                                       const SwarmConfig& config,
                                       const std::vector<std::string>& overrides = {});

}  // namespace stg::learn

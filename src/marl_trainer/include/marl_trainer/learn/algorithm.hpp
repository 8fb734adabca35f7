#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/checkpoint/archive.hpp"
#include "marl_trainer/learn/comm/groups.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::learn {

/// The learning problem: identical AUVs with one observation each, and a state of the whole swarm
/// for a critic.
struct Problem {
  int agents = 1;
  int observation_size = 1;
  int state_size = 1;
  int action_size = 1;
  double action_scale = 1.0;             ///< actions of a policy lie in +-action_scale
  double workspace_half_extent_m = 0.0;  ///< [m], for units for the distance to walls; 0: none
};

/// A group of environments that one worker steps during a collection.
struct Shard {
  static constexpr int kEnvs = 16;  ///< of a full shard

  int first_env = 0;  ///< index of its first environment among all
  int envs = 0;
  int group = 0;  ///< GroupShare's; a shard is in one group
};

/// The shards of `count` groups from `first` on; `envs` is the number of all environments. A shard
/// ends where its group ends, or when it is full.
std::vector<Shard> ShardsOf(const GroupShare& share, int first, int count, int envs);

/// One collection: every environment makes `steps` decisions. Episodes continue in the next
/// collection.
struct Collection {
  std::uint32_t number = 0;
  int steps = 0;
  std::vector<Shard> shards;
  bool taught = false;  ///< transitions contain the actions of a teacher
};

/// Keys of the counter-based draws of one decision: an AUV's draw depends on them and on its index
/// among all, (first_env + env) * agents + agent, so neither on workers nor on shards.
struct DrawKeys {
  std::uint64_t seed = 0;
  std::uint32_t collection = 0, step = 0;
  int first_env = 0;
};

/// One decision of every AUV of some environments.
struct Decision {
  int envs = 0;
  const float* observations = nullptr;  ///< [envs, agents, observation_size], raw
  const DrawKeys* explore = nullptr;    ///< null: the deterministic policy
  int worker = 0;                       ///< selects the scratch memory
};

/// Where a decision is written.
struct Actions {
  float* actions = nullptr;  ///< [envs, agents, action_size]; the environment clips to +-1
  /// [envs, agents], natural log of the density of an explored action. Algorithms without a density
  /// do not write it. Null: the caller does not need it.
  float* log_prob = nullptr;
};

/// One step of the environments of a shard. A null pointer: unknown.
struct Transition {
  int shard = 0, step = 0, envs = 0;    ///< step in the collection
  const float* observations = nullptr;  ///< [envs, agents, observation_size], input of the decision
  const float* states = nullptr;        ///< [envs, state_size], before the step
  const float* actions = nullptr;       ///< [envs, agents, action_size], before clipping
  const float* log_prob = nullptr;      ///< [envs, agents], of these actions when they were drawn
  const float* teacher = nullptr;       ///< [envs, agents, action_size], in a taught collection
  const float* rewards = nullptr;       ///< [envs, agents]; unknown in recordings
  const float* team_rewards = nullptr;  ///< [envs], their mean over agents
  /// [envs], 1 where the episode ended. It always ends by truncation: bootstrap with the final
  /// state, never mask it.
  const std::uint8_t* truncated = nullptr;
  /// Observations and states of the next decision; where truncated, of the next episode.
  const float* next_observations = nullptr;
  const float* next_states = nullptr;
  /// Of the episode that ended; rows are valid where truncated.
  const float* final_observations = nullptr;
  const float* final_states = nullptr;
};

/// Input of an update besides the transitions.
struct UpdateContext {
  double progress = 0.0;   ///< share of the run's steps that are done, in [0, 1]
  double imitation = 0.0;  ///< share of the actor's loss that is imitation, in [0, 1]
};

/// A number that every update reports.
struct ReportColumn {
  std::string name;   ///< in progress.csv
  std::string label;  ///< in the progress line; empty: not there
  int decimals = 3;   ///< in the progress line
};

/// Result of an update: the numbers of Algorithm::Columns, in that order.
struct UpdateReport {
  std::vector<double> values;
  double flops = 0.0;  ///< floating-point operations in matrix products
};

/// Number of trained parameters of a network, without target networks.
struct NetworkSize {
  std::string name;
  std::size_t parameters = 0;
};

/// A learning algorithm. Collection, evaluation, logging, checkpoints and export use only this
/// interface.
///
///   Begin, { Act, Observe } for every step of every shard, Update, Begin, ...
///
/// Act may run concurrently for different workers, and Observe for different shards. The steps of a
/// shard come in order; no other function runs at the same time. For recorded episodes only Observe
/// is called. Results must not depend on the number of workers or on the distribution of the work.
/// With several ranks, each rank observes environments of its own, and all have the same state
/// after an update.
class Algorithm {
 public:
  virtual ~Algorithm() = default;

  /// Prepares for the transitions of a collection.
  virtual void Begin(const Collection& collection) = 0;
  virtual void Act(const Decision& decision, const Actions& out) = 0;
  virtual void Observe(const Transition& transition) = 0;
  /// Learns from the transitions since Begin, and from older data that the algorithm keeps.
  virtual UpdateReport Update(const UpdateContext& context) = 0;

  /// Stores everything that a resumed run needs: weights, optimiser, normalisers, replayed
  /// transitions. Called between Update and Begin.
  virtual void Save(Archive* archive) const = 0;
  /// Throws UserError for the archive of another algorithm or of other sizes.
  virtual void Load(const Archive& archive) = 0;
  /// Takes networks and normalisers of another run, not optimiser or exploration. Throws UserError.
  virtual void StartFrom(const Archive& archive);
  /// Takes the actor and its normaliser from a policy file of the same shape. Throws UserError.
  virtual void StartFrom(const agent::Policy& policy);

  /// The policies of the AUVs: one for all, or one for each.
  virtual std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const = 0;
  virtual std::vector<ReportColumn> Columns() const = 0;
  /// All trained networks; a network that several AUVs share is listed once. Empty: the algorithm
  /// does not report them.
  virtual std::vector<NetworkSize> Sizes() const { return {}; }
};

}  // namespace stg::learn

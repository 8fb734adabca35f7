#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/collect/imitation.hpp"
#include "marl_trainer/learn/comm/team.hpp"
#include "marl_trainer/learn/train_config.hpp"
#include "stg_env/env/vector_env.hpp"
#include "stg_env/task/metrics.hpp"

namespace stg::learn {

/// Results of one collection.
struct CollectionReport {
  std::vector<task::EpisodeMetrics> finished;  ///< episodes that ended in this collection
  double reward = 0.0;                         ///< team's reward, mean over steps
  /// Wall-clock time of the workers, by task [s].
  double env_seconds = 0.0, inference_seconds = 0.0;
};

/// The sizes that an algorithm needs.
Problem ProblemOf(const RunConfig& run, const dynamics::WorldConfig& world,
                  const agent::AgentConfig& agent);

/// Runs the environments with an algorithm: the only collection loop. The environments are divided
/// into fixed shards. A worker steps a shard through a whole collection without waiting for others.
/// So results depend neither on the number of workers nor on the number of ranks.
class Collector {
 public:
  /// @param make_env factory for the scenarios that the environments cycle through; its agents have
  /// the knowledge that the imitated controller needs.
  /// @param imitation names the controller to ask; null: none
  /// @param team each of its ranks has a share of the environments.
  Collector(const env::EnvFactory& make_env, const TrainConfig& config,
            const ImitationConfig* imitation, const Team& team);
  ~Collector();

  /// Makes `config.horizon` decisions of every environment of this rank, with exploration. Call it
  /// after algorithm->Begin.
  /// @param number keys the draws of the exploration.
  /// @param teach also ask the imitated controller in every visited state.
  CollectionReport Collect(std::uint32_t number, bool teach, Algorithm* algorithm);

  /// Starts the k-th episode of every environment.
  void RestartAt(std::uint64_t k);
  /// Treats the present as the last common start of an episode. Every environment must be at the
  /// start of an episode now.
  void ForgetPast();
  /// Stores the actions since the last common start of an episode. They are enough to reach the
  /// present state again, in all ranks.
  void Save(Archive* archive) const;
  /// Goes to the state in which Save was called. Call it after RestartAt of the same start. Throws
  /// UserError for an archive of other environments or other shards.
  void Load(const Archive& archive);
  /// The largest number k of a running episode, over all ranks.
  std::uint64_t round() const;
  /// True if every environment of all ranks is at the start of an episode.
  bool at_episode_start() const;

 private:
  class Unit;

  const int envs_, horizon_;
  const Team team_;
  std::vector<std::unique_ptr<Unit>> units_;
  std::set<std::string> places_;  // names of the shards of all ranks in an archive
};

}  // namespace stg::learn

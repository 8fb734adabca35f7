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

/// What one collection saw.
struct CollectionReport {
  std::vector<task::EpisodeMetrics> finished;  ///< episodes that ended in it
  double reward = 0.0;                         ///< mean over steps of the team's reward
  /// Wall-clock time, split by where the workers spent theirs.
  double env_seconds = 0.0, inference_seconds = 0.0;
};

/// Sizes that an algorithm needs.
Problem ProblemOf(const RunConfig& run, const dynamics::WorldConfig& world,
                  const agent::AgentConfig& agent);

/// Brings environments and algorithm together: the one collection loop. The environments are cut
/// into fixed shards that a worker steps through a whole collection without waiting for others, so
/// results depend neither on the number of workers nor on that of ranks.
class Collector {
 public:
  /// @param make_env of the scenarios that the environments cycle through; its agents know what
  /// the controller to imitate knows.
  /// @param imitation whose controller to ask; null: none
  /// @param team whose ranks have a share of the environments each.
  Collector(const env::EnvFactory& make_env, const TrainConfig& config,
            const ImitationConfig* imitation, const Team& team);
  ~Collector();

  /// `config.horizon` decisions of every environment of this rank with exploration, after
  /// algorithm->Begin.
  /// @param number keys the draws of the exploration.
  /// @param teach also ask the controller to imitate, at every state visited.
  CollectionReport Collect(std::uint32_t number, bool teach, Algorithm* algorithm);

  /// Starts the k-th episode of every environment.
  void RestartAt(std::uint64_t k);
  /// Takes the present, where every environment starts an episode, for the last such start.
  void ForgetPast();
  /// What was done since the last common start of an episode, which is enough to get back here, in
  /// all ranks.
  void Save(Archive* archive) const;
  /// After RestartAt of that start: goes to where Save was called. Throws UserError for an archive
  /// of other environments or of other shards.
  void Load(const Archive& archive);
  /// The largest k of an episode that runs, in any rank.
  std::uint64_t round() const;
  /// True when every environment of all ranks stands at the start of an episode.
  bool at_episode_start() const;

 private:
  class Unit;

  const int envs_, horizon_;
  const Team team_;
  std::vector<std::unique_ptr<Unit>> units_;
  std::set<std::string> places_;  // names of all ranks' shards in an archive
};

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

/// A cooperative game with a known optimum. Everybody sees the same number x, which does not depend
/// on what was done; nobody is told who it is.
struct Game {
  int agents = 2;
  int episode = 5;  ///< steps until truncation
  double scale = 1.0;
  /// x after so many steps of an episode, the last one's included; empty: drawn anew in [-1, 1].
  std::function<double(int step)> path;
  /// Of the actions [agents] at x.
  std::function<double(double x, const float* actions)> reward;
  /// What an agent calls its own of it; empty: all of it. For methods that learn from that.
  std::function<double(double x, const float* actions, int agent)> own_reward;
  /// What a teacher would do at x as this agent; empty: nobody teaches.
  std::function<double(double x, int agent)> teacher;

  Problem problem() const;
};

/// The third of [-scale, scale] that an action lies in: 0, 1, 2.
int Third(float action, double scale = 1.0);

/// The named algorithm with options for small games, over which those of `options` go.
TrainSetup GameSetup(const std::string& algorithm, const nlohmann::json& options = {});

/// A training at a game: algorithm, threads, and how far it is.
class Training {
 public:
  Training(const Game& game, const TrainSetup& setup, int workers = 1);

  /// Plays and updates; returns the mean reward of the last collection.
  /// @param progress share of the run that is over, see UpdateContext
  double Run(int collections, double progress = 0.0);
  /// Actions [agents] of the deterministic policy at x.
  std::vector<float> Act(double x);
  /// What the last update reported under this name.
  double Reported(const std::string& column) const;

  /// Bit for bit what a checkpoint holds.
  Archive Save() const;
  void Load(const Archive& archive) { algorithm_->Load(archive); }
  /// As a resumed run: goes on with this collection.
  void ContinueAt(std::uint32_t collection) { collection_ = collection; }

  Algorithm& algorithm() { return *algorithm_; }

 private:
  void PlayShard(const Collection& collection, int shard, int worker, double* reward);
  float Context(int env, std::int64_t time, std::int64_t step) const;

  const Game game_;
  const TrainSetup setup_;
  WorkerPool pool_;
  std::unique_ptr<Algorithm> algorithm_;
  std::uint32_t collection_ = 0;
  int planned_ = 1;
  UpdateReport report_;
};

}  // namespace stg::learn

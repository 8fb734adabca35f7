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

/// A cooperative game with a known optimum. All agents see the same number x, which does not depend
/// on their actions. No agent knows which one it is.
struct Game {
  int agents = 2;
  int episode = 5;  ///< steps until truncation
  double scale = 1.0;
  /// x after so many steps of an episode, its last step included. Empty: x is drawn anew in [-1,
  /// 1].
  std::function<double(int step)> path;
  /// The reward of the actions [agents] at x.
  std::function<double(double x, const float* actions)> reward;
  /// An agent's own part of the reward, for methods that learn from it. Empty: the whole reward.
  std::function<double(double x, const float* actions, int agent)> own_reward;
  /// What the teacher of this agent would do at x. Empty: there is no teacher.
  std::function<double(double x, int agent)> teacher;

  Problem problem() const;
};

/// The third of [-scale, scale] that an action lies in: 0, 1, 2.
int Third(float action, double scale = 1.0);

/// The named algorithm with options for small games. The entries of `options` replace them.
TrainSetup GameSetup(const std::string& algorithm, const nlohmann::json& options = {});

/// The training of an algorithm at a game, with its threads and its progress.
class Training {
 public:
  Training(const Game& game, const TrainSetup& setup, int workers = 1);

  /// Plays and updates. Returns the mean reward of the last collection.
  /// @param progress share of the run that is over, see UpdateContext
  double Run(int collections, double progress = 0.0);
  /// Actions [agents] of the deterministic policy at x.
  std::vector<float> Act(double x);
  /// The number that the last update reported by this name.
  double Reported(const std::string& column) const;

  /// The content of a checkpoint, bit for bit.
  Archive Save() const;
  void Load(const Archive& archive) { algorithm_->Load(archive); }
  /// Goes on with this collection, as a resumed run does.
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

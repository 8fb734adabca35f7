#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "marl_trainer/learn/recorded/recorded.hpp"
#include "marl_trainer/learn/run/run_folder.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

/// Trains an on-policy algorithm on recorded episodes. Each update makes a new policy with its own
/// id. Episodes of any other policy are refused.
///
/// The folder contains the next policy to fly, policy_last.onnx, and checkpoints. If it contains a
/// checkpoint, the training continues from it.
class RecordedTrainer {
 public:
  struct Options {
    std::string out;  ///< folder; it is created
    std::string
        policy;  ///< ONNX file to start from; empty: the folder's checkpoint, else untrained
    int workers = 1;
    std::ostream* log = nullptr;
  };

  /// Results of one update.
  struct Progress {
    std::int64_t updates = 0, env_steps = 0;
    int episodes = 0;
    double episode_return = 0.0;  ///< sum over steps and AUVs, mean over episodes
    bool own_reward = false;      ///< this is by a reward of the training, not the scenario's
    std::string report;           ///< numbers of the algorithm, see ReportText
    double seconds = 0.0;
  };

  /// Throws UserError for a policy or folder that does not fit scenario and setup.
  /// @param setup its envs and horizon are not used, because a collection is a number of whole
  /// episodes.
  RecordedTrainer(const Scenario& scenario, const TrainSetup& setup, const Options& options);

  Finding Check(const RecordedEpisode& episode) const;
  /// Makes one update on at least one episode; all must have passed Check. Writes policy and
  /// checkpoint.
  Progress Update(const std::vector<RecordedEpisode>& episodes);

  const agent::Policy& policy() const { return *policy_; }
  const std::string& policy_id() const { return policy_->metadata().id; }
  std::string policy_path() const { return folder_.PolicyPath("policy_last"); }
  std::int64_t updates() const { return state_.collections; }
  std::int64_t env_steps() const { return state_.env_steps; }
  int state_size() const { return problem_.state_size; }
  const Algorithm& algorithm() const { return *algorithm_; }

 private:
  RecordedTrainer(const Scenario& scenario, const TrainSetup& setup, const Options& options,
                  const std::shared_ptr<const agent::Policy>& start);
  void Restore(const TrainState& state, const agent::Policy* start);
  /// Passes an episode to the algorithm. Returns the sum of its rewards.
  double Observe(const RecordedEpisode& episode, int shard);
  agent::Policy MakePolicy() const;

  const Scenario scenario_;
  const TrainSetup setup_;
  const Options options_;
  const Problem problem_;
  WorkerPool pool_;
  std::unique_ptr<Algorithm> algorithm_;
  RunFolder folder_;
  TrainState state_;
  std::shared_ptr<const agent::Policy> policy_;
};

/// Defaults for updates on a few whole episodes: more passes over less data than in the presets.
TrainSetup RecordedSetup(const RunConfig& run, const std::string& algorithm = DefaultAlgorithm());

}  // namespace stg::learn

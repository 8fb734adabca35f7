#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "marl_trainer/learn/algorithms/mappo/learner.hpp"
#include "marl_trainer/learn/recorded/recorded.hpp"

namespace stg::learn {

/// MAPPO on recorded episodes. Each update makes a new policy with an id of its own; episodes of
/// any other policy are refused.
///
/// The folder holds the policy to fly with next, policy_last.onnx, and checkpoints. Where it holds
/// a checkpoint, training goes on from there.
class RecordedTrainer {
 public:
  struct Options {
    std::string out;  ///< folder, created
    std::string
        policy;  ///< ONNX file to start from; empty: the folder's checkpoint, else untrained
    int workers = 1;
    std::ostream* log = nullptr;
  };

  /// What one update did.
  struct Progress {
    std::int64_t updates = 0, env_steps = 0;
    int episodes = 0;
    double episode_return = 0.0;  ///< summed over steps and AUVs, mean over episodes
    double kl = 0.0, clip_fraction = 0.0, explained_variance = 0.0, sigma = 0.0;
    double seconds = 0.0;
  };

  /// Throws UserError for a policy or folder that does not fit scenario and configuration.
  /// @param config its envs and horizon are not used: a collection is a number of whole episodes.
  RecordedTrainer(const Scenario& scenario, const TrainConfig& config, const Options& options);

  Finding Check(const RecordedEpisode& episode) const;
  /// One update on episodes that passed Check; at least one. Writes policy and checkpoint.
  Progress Update(const std::vector<RecordedEpisode>& episodes);

  const agent::Policy& policy() const { return *policy_; }
  const std::string& policy_id() const { return policy_->metadata().id; }
  std::string policy_path() const;
  const TrainState& state() const { return state_; }
  int state_size() const { return learner_.networks().critic.inputs(); }

 private:
  RecordedTrainer(const Scenario& scenario, const TrainConfig& config, const Options& options,
                  const std::shared_ptr<const agent::Policy>& start);
  void Restore(const TrainState& state, const agent::Policy* start);
  void StartFrom(const agent::Policy& policy);
  RolloutBuffer Rollout(const RecordedEpisode& episode);
  agent::Policy MakePolicy() const;

  const Scenario scenario_;
  const TrainConfig config_;
  const Options options_;
  WorkerPool pool_;
  Learner learner_;
  TrainState state_;
  Mlp::Workspace critic_;
  RunningMoments observation_moments_, state_moments_;  ///< raw, of the present collection
  std::shared_ptr<const agent::Policy> policy_;
};

/// Defaults for updates on few whole episodes: more passes over less data than the presets.
/// The minibatch is the largest divisor of the episode up to 500 steps.
TrainConfig RecordedConfig(const Scenario& scenario);

}  // namespace stg::learn

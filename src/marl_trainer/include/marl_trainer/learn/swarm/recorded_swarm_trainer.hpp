#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "marl_trainer/learn/recorded/recorded_trainer.hpp"
#include "marl_trainer/learn/run/run_folder.hpp"
#include "marl_trainer/learn/swarm/swarm_learner.hpp"
#include "marl_trainer/learn/swarm/swarm_recording.hpp"

namespace stg::learn {

/// What a training with swarms starts from: a policy file, or the checkpoint of `train_swarm`.
struct SwarmStart {
  std::string path;                                   ///< empty: an untrained network
  std::shared_ptr<const agent::EntityPolicy> policy;  ///< of a file
  std::optional<Archive> learner;                     ///< of a folder
};

/// Whether a folder holds the checkpoint of `train_swarm`.
bool HoldsSwarmCheckpoint(const std::string& folder);
/// Reads an ONNX file or a folder of `train_swarm`, and sets network and action of the
/// configuration to what it holds. Throws UserError for another layout or a damaged file.
SwarmStart ReadSwarmStart(const std::string& path, SwarmConfig* config);

/// Trains a network over entities on recorded episodes with SwarmLearner, the learner of
/// SwarmTrainer. Each update makes a new policy with its own id, and its mean over the last
/// updates. The rest is as in RecordedTrainer.
class RecordedSwarmTrainer {
 public:
  struct Options {
    std::string out;                ///< folder; it is created
    int critic_updates = 0;         ///< first updates, in which only the critic learns
    std::optional<double> log_std;  ///< of the exploration; empty: that of the start
    int workers = 1;
    int keep_checkpoints = 3;
    std::ostream* log = nullptr;
  };

  /// Throws UserError for a start or folder that does not fit scenario and configuration.
  RecordedSwarmTrainer(const Scenario& scenario, const SwarmConfig& config, const SwarmStart& start,
                       const Options& options);

  Finding Check(const SwarmEpisode& episode) const;
  /// Makes one update on at least one episode; all must have passed Check. Writes policy and
  /// checkpoint. The return of Progress is by the reward of the training.
  RecordedTrainer::Progress Update(const std::vector<SwarmEpisode>& episodes);

  /// The scenario with the reward of the training, which the outcomes of an episode follow.
  const Scenario& scenario() const { return scenario_; }
  const agent::EntityPolicy& policy() const { return *policy_; }
  const std::string& policy_id() const { return policy_->metadata().id; }
  /// The file of the policy, with which agents explore.
  std::string policy_path() const { return folder_.PolicyPath("policy_last"); }
  /// The file of its mean over the last updates (SwarmConfig::average), to fly with.
  std::string average_path() const { return folder_.PolicyPath("policy_average"); }
  std::int64_t updates() const { return state_.collections; }
  std::int64_t env_steps() const { return state_.env_steps; }
  const SwarmLearner& learner() const { return learner_; }

 private:
  void Restore(const TrainState& state, const SwarmStart& start);
  void WritePolicies();

  const Scenario scenario_;
  const SwarmConfig config_;
  const Options options_;
  WorkerPool pool_;
  SwarmLearner learner_;
  RunFolder folder_;
  TrainState state_;
  std::shared_ptr<const agent::EntityPolicy> policy_;
};

/// Defaults for updates on a few whole episodes: smaller minibatches than in `train_swarm`, and the
/// learning rate stays the same.
SwarmConfig RecordedSwarmConfig();

}  // namespace stg::learn

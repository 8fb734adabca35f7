#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "auv_dynamics/world/world.hpp"
#include "marl_trainer/task/metrics.hpp"
#include "marl_trainer/task/reward.hpp"
#include "stg_agent/graph/observation.hpp"

namespace stg::agent {
class AgentView;
}
namespace stg::acoustics {
class Channel;
}

namespace stg::env {

/// Which episodes an EnvGroup draws.
struct EnvOptions {
  /// Episode r of all copies together (r = env + k * total_envs, k-th episode of
  /// environment env) is drawn from seed + r.
  std::uint64_t seed = 0;
  int first_env = 0;  ///< index of lane 0
  int total_envs = kLanes;
  bool curriculum = false;  ///< easy, medium, hard by r (scenario.reset); else the scenario's stage
  int first_episode_steps = 0;  ///< > 0: the first episode is this short, to spread episode ends
};

/// True state of a swarm that moves elsewhere, and what led to it.
struct FollowedSwarm {
  std::vector<dynamics::NavState> vehicles;            ///< [agents]
  std::vector<dynamics::TargetState<double>> targets;  ///< [targets]
  /// [agents]: tau / tau_max and executed action of the decision that led here.
  std::vector<std::array<double, 6>> fractions, actions;
  double link_quality = 0.0;  ///< mean over AUVs of the mean link quality each one knows, now
};

/// kLanes environments in lockstep, one per SIMD lane: world, sensing, channel
/// and agents (acoustic mode), observation, reward and metrics. Episodes end by
/// truncation only and restart at once. Not thread-safe; use one per worker.
class EnvGroup {
 public:
  EnvGroup(const Scenario& scenario, const EnvOptions& options);
  ~EnvGroup();
  EnvGroup(EnvGroup&&) noexcept;

  /// Starts the first episode of every lane.
  void Reset();
  /// One decision of every AUV. `actions` is [kLanes, agents, action_size];
  /// values are clipped to [-1, 1].
  void Step(const float* actions);
  void Step(const double* actions);

  int agents() const { return scenario_.agents; }
  int action_size() const { return scenario_.action_size(); }
  int observation_size() const { return observation_size_; }
  int state_size() const { return 19 * scenario_.agents + 6 * scenario_.target.count; }
  const Scenario& scenario() const { return scenario_; }

  /// [kLanes, agents, observation_size], of the current decision.
  const float* observations() const { return observations_.data(); }
  /// [kLanes, state_size]: true state of the whole swarm, for the critic.
  const float* states() const { return states_.data(); }
  /// [kLanes]: mean over AUVs of the last step's reward.
  const float* rewards() const { return rewards_.data(); }
  /// True when the last step ended the episode of every lane (by truncation);
  /// observations() and states() then already belong to the next episode.
  bool truncated() const { return truncated_; }
  /// As observations() and states(), before the restart. Valid while truncated().
  const float* final_observations() const { return final_observations_.data(); }
  const float* final_states() const { return final_states_.data(); }
  /// Valid while truncated().
  const task::EpisodeMetrics& metrics(int lane) const {
    return finished_[static_cast<size_t>(lane)];
  }

  /// Decisions made in the current episode, and k of the EnvOptions::seed rule.
  int step() const { return step_; }
  std::uint64_t round() const { return round_; }
  /// Restarts all lanes at the start of their k-th episode (resuming a run).
  void RestartAt(std::uint64_t round, int first_episode_steps);

  // For built-in controllers, tests and traces.
  const dynamics::World& world() const { return world_; }
  agent::AgentView agent(int lane, int i) const;      ///< acoustic mode
  const acoustics::Channel& channel(int lane) const;  ///< acoustic mode
  const task::RewardTerms<Pack>& terms(int i) const { return terms_[static_cast<size_t>(i)]; }
  const agent::Knowledge<Pack>& truth(int i) const { return truth_[static_cast<size_t>(i)]; }
  /// Starts an episode of every lane from given states (golden traces).
  void Place(const std::vector<Vec3<double>>& p_WB, const std::vector<Vec3<double>>& p_WT,
             const std::vector<Vec3<double>>& v_WT);

  /// For a swarm that moves elsewhere, such as a graph of nodes: judges its true states as if they
  /// were this object's own. All lanes are alike. Build the object in truth mode: it has no agents
  /// to run. Rewards, states, terms, truncated and metrics are then as after Step, except that a
  /// finished episode does not restart.
  void FollowStart(const FollowedSwarm& swarm);
  void FollowStep(const FollowedSwarm& swarm);
  /// Metrics of the present episode up to now.
  task::EpisodeMetrics MetricsSoFar(int lane) const;

 private:
  struct Totals;
  struct Acoustic;

  void StartEpisode();
  void BeginSemantics();
  void Measure(bool first);
  Pack MeanError(size_t i, const Pack& error);
  void NeighbourFeatures(int i, agent::Knowledge<Pack>* k) const;
  void Step();
  void TruthActions();
  void AcousticActions();
  void AcousticObserve();
  void ComputeRewards();
  void WriteObservations();
  void WriteStates();
  void FinishEpisode();

  Scenario scenario_;
  EnvOptions options_;
  dynamics::World world_;
  int observation_size_;
  int step_ = 0;
  int episode_steps_;
  std::uint64_t round_ = 0;
  bool truncated_ = false;
  std::optional<Pack> followed_quality_;

  std::vector<agent::Knowledge<Pack>> truth_;    // what the truth mode lets each AUV know
  std::vector<std::vector<Pack>> error_window_;  // [agent][k]
  std::vector<std::array<Pack, 6>> action_, previous_action_, tau_, previous_tau_;
  std::vector<dynamics::Wrench<Pack>> wrench_;
  std::vector<task::RewardTerms<Pack>> terms_;
  std::unique_ptr<Totals> totals_;
  std::unique_ptr<Acoustic> acoustic_;
  std::vector<double> actions_;  // [lane, agent, action]
  std::vector<float> observations_, states_, rewards_, final_observations_, final_states_;
  std::vector<task::EpisodeMetrics> finished_;
};

}  // namespace stg::env

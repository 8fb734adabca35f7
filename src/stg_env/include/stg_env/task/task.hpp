#pragma once

#include <memory>
#include <vector>

#include "stg_env/task/critic_state.hpp"
#include "stg_env/task/episode_totals.hpp"
#include "stg_env/task/judge_config.hpp"
#include "stg_env/task/reward.hpp"
#include "stg_env/task/reward_term.hpp"
#include "stg_env/task/swarm_state.hpp"

namespace stg::task {

/// Computes from a swarm's true states the reward of each AUV, the metrics of the episode and the
/// critic's state. It does not depend on what moves the swarm. T = double: one swarm. T = Pack:
/// kLanes swarms, each with its own episode.
///
/// Use: Start when an episode begins, and Step after each decision.
template <class T>
class Task {
 public:
  explicit Task(const JudgeConfig& scenario);

  /// Starts an episode of `episode_steps` decisions in some lanes; `swarm` is its first state. In
  /// other lanes, the state must be the same as in the last Start or Step.
  void Start(const Mask<T>& lanes, const SwarmState<T>& swarm, const T& episode_steps);
  /// Judges the decision that led to `swarm`.
  void Step(const SwarmState<T>& swarm);

  /// Of the last decision.
  const RewardTerms<T>& terms(int i) const { return terms_[static_cast<std::size_t>(i)]; }
  const T& team_reward() const { return team_reward_; }  ///< mean of the AUVs' totals
  /// At the last state.
  const Tracking<T>& tracking(int i) const { return tracking_[static_cast<std::size_t>(i)]; }
  /// Decisions of the episode.
  int steps(int lane) const { return static_cast<int>(Lane(totals_.steps(), lane)); }
  /// Metrics of the episode up to now, after at least one decision.
  EpisodeMetrics Metrics(int lane) const { return totals_.Metrics(lane); }

  /// The critic's state for the last state given to Start or Step; see task::WriteCriticState.
  template <class Emit>
  void WriteCriticState(const SwarmState<T>& swarm, Emit&& emit) const {
    task::WriteCriticState(scenario_, swarm, tracking_, std::forward<Emit>(emit));
  }

 private:
  struct Weighted {
    double weight;
    std::unique_ptr<const RewardTerm> term;
  };

  /// @param starting lanes in which an episode starts; the others keep d(t-1). Null: a decision.
  void Measure(const SwarmState<T>& swarm, const Mask<T>* starting);
  /// Coordination and communication, which are the same for all AUVs.
  void ShareReward(const SwarmState<T>& swarm, T* coordination, T* communication) const;
  /// Stores the values with which the next decision is compared.
  void Remember(const SwarmState<T>& swarm);
  RewardInput<T> InputOf(const SwarmState<T>& swarm, int i) const;

  JudgeConfig scenario_;
  std::vector<Weighted> extra_;  // registered terms with a weight above 0
  std::vector<Tracking<T>> tracking_;
  std::vector<T> followed_;  // target of each AUV at the last state, with task.assignment free
  std::vector<RewardTerms<T>> terms_;
  Efforts<T> previous_tau_, previous_action_;
  T team_reward_ = T(0.0);
  EpisodeTotals<T> totals_;
};

extern template class Task<double>;
extern template class Task<Pack>;

}  // namespace stg::task

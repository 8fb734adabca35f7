#pragma once

#include <vector>

#include "stg_env/task/field_totals.hpp"
#include "stg_env/task/judge_config.hpp"
#include "stg_env/task/metrics.hpp"
#include "stg_env/task/reward.hpp"
#include "stg_env/task/swarm_state.hpp"

namespace stg::task {

/// Sums for EpisodeMetrics. Each lane counts its own decisions.
template <class T>
class EpisodeTotals {
 public:
  explicit EpisodeTotals(const JudgeConfig& scenario);

  /// Starts an episode of `episode_steps` decisions in some lanes.
  void Start(const Mask<T>& lanes, const T& episode_steps);
  /// Adds a decision with its rewards. @param tracking, terms [agents]
  void Add(const SwarmState<T>& swarm, const std::vector<Tracking<T>>& tracking,
           const std::vector<RewardTerms<T>>& terms);
  /// Decisions since the start, as whole numbers.
  const T& steps() const { return steps_; }
  /// Metrics of the episode up to now, after at least one decision.
  EpisodeMetrics Metrics(int lane) const;

 private:
  /// One sum over the decisions of an episode and, with `of_tail`, over its last ones.
  struct Sums {
    T episode_return = T(0.0), norm = T(0.0), saturated = T(0.0), cost = T(0.0), track = T(0.0),
      observation = T(0.0), coordination = T(0.0), communication = T(0.0), semantic = T(0.0),
      crowding = T(0.0), error = T(0.0), lost = T(0.0), pairs = T(0.0);
    T tail_distance = T(0.0), tail_error = T(0.0), tail_lost = T(0.0), tail_band = T(0.0),
      tail_pairs = T(0.0);
  };
  void AddTail(const Mask<T>& tail, const SwarmState<T>& swarm,
               const std::vector<Tracking<T>>& tracking);

  int agents_, action_size_, episode_steps_, tail_steps_;
  double decision_dt_s_;
  config::Interval band_m_;
  T steps_ = T(0.0), length_ = T(0.0), counted_tail_ = T(0.0);
  T separation_ = T(1e9);
  Sums sums_;
  FieldTotals<T> field_;
  bool in_field_ = false;   // the last decision had a field
  std::vector<T> entered_;  // first decision of each AUV within d_u; -1: not yet
};

extern template class EpisodeTotals<double>;
extern template class EpisodeTotals<Pack>;

}  // namespace stg::task

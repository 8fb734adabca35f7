#pragma once

#include <string>
#include <utility>
#include <vector>

namespace stg::task {

/// Metrics of one episode (Table S1 and what the paper leaves out). Tail: the
/// last tail_steps decisions. Means over AUVs and decisions unless named.
struct EpisodeMetrics {
  double episode_return = 0.0;         ///< sum over decisions and AUVs
  double tail_distance = 0.0;          ///< d over the tail [m]
  double tracking_error = 0.0;         ///< |d - d*| over the tail [m]
  double lost_rate = 0.0;              ///< share of the tail with d > lost distance
  double action_norm = 0.0;            ///< norm of tau / tau_max
  double saturation_rate = 0.0;        ///< share of executed action components >= 0.95
  double control_cost = 0.0;           ///< cost of Eq. 35
  double communication_quality = 0.0;  ///< communication term of the reward
  double band_rate = 0.0;              ///< share of the tail inside [d_l, d_u]
  double colliding_pairs = 0.0;        ///< pairs in contact, per decision
  double tail_colliding_pairs = 0.0;
  double min_separation = 0.0;  ///< smallest distance between two AUVs, whole episode [m]
  double time_to_band =
      0.0;  ///< first entry of d_u, mean over AUVs; the episode length when never [s]
  double mean_error = 0.0;       ///< |d - d*| over the whole episode [m]
  double whole_lost_rate = 0.0;  ///< lost over the whole episode
  double reward_track = 0.0, reward_observation = 0.0, reward_coordination = 0.0,
         reward_communication = 0.0, reward_semantic = 0.0, reward_separation = 0.0;
  int steps = 0;

  /// Name and value of every metric, in the order of tables and JSON.
  std::vector<std::pair<std::string, double>> Items() const;
};

/// Mean and sample standard deviation of each metric over episodes.
struct MetricSummary {
  std::vector<std::string> names;
  std::vector<double> mean, std;
  int episodes = 0;

  /// Mean of the metric called `name`; 0 where there is none.
  double Mean(const std::string& name) const;
};
MetricSummary Summarise(const std::vector<EpisodeMetrics>& episodes);

}  // namespace stg::task

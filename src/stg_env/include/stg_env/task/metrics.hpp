#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stg_env/task/estimate_metrics.hpp"

namespace stg::task {

/// Metrics with task.assignment free.
struct ChoiceMetrics {
  double switches = 0.0;  ///< changes to another target, per AUV
  /// Distance between the set of an AUV's target estimates and the set of targets, mean over AUVs
  /// and decisions (DistanceOfSets with a cutoff of 100 m) [m].
  double ospa = 0.0, gospa = 0.0;
  /// With unlabelled detections: how often an estimate has become one of another target, per AUV.
  std::optional<double> swaps;
  /// With labelled detections: mean over targets and decisions of the horizontal error of the
  /// estimate that the AUV nearest to the target has of it [m]. UTracking (arXiv 2505.08222)
  /// reports this error.
  std::optional<double> nearest_error;
};

/// Metrics of search: detection, surrounding and following of targets.
struct SearchMetrics {
  double found = 0.0;           ///< 1: each target was observed by an AUV
  double time_to_detect = 0.0;  ///< until then, mean over targets; the episode length if never [s]
  double time_to_gather = 0.0;  ///< until all AUVs were in the band at once; the same if never [s]
  /// Mean of 1 - |mean of e^{2 i theta}| over the AUVs' bearings from a target: 0 where all are on
  /// one line through it, because their ranges then determine one axis only.
  double info_spread = 0.0;
  /// Share of targets and decisions with two AUVs in the band (one, if there are fewer than two for
  /// each target) and with an error of the followers' best estimate below 20 m in the plane.
  double followed = 0.0;
  double worst_followed = 0.0;  ///< the same for the target with the lowest share
  /// Displacement of the targets over 600 s as a share of their way; 0 in shorter episodes.
  double target_net_speed = 0.0;
  std::optional<ChoiceMetrics> choices;

  std::vector<std::pair<std::string, double>> Items() const;
};

/// Metrics of ranging by pings (sensing.ranging, localization.ranges.by).
struct PingMetrics {
  double pings = 0.0;          ///< sent pings, per AUV
  double loss = 0.0;           ///< share of the pings without an answer
  double airtime_share = 0.0;  ///< share of the time in which a modem sends pings or packets
};

/// Further metrics of one whole episode in open water.
struct FieldMetrics {
  double estimate_rmse = 0.0;    ///< error of the estimated position in the world, with depth [m]
  double nees = 0.0;             ///< mean normalised squared error; 3 for a consistent estimate
  double estimate_known = 0.0;   ///< share of AUV decisions with an estimate
  double information_age = 0.0;  ///< mean age of the newest observation in the estimates [s]
  EstimateMetrics estimates;
  SearchMetrics search;
  std::optional<NavigationMetrics> navigation;  ///< with a localizer
  std::optional<PingMetrics> pings;             ///< with pings, in environments only
  double band_share = 0.0;                      ///< share of AUV decisions inside [d_l, d_u]
  double worst_band_share = 0.0;                ///< of the AUV with the lowest share
  double time_lost = 0.0;                       ///< mean over AUVs [s]
  double time_to_reacquire = 0.0;  ///< mean length of ended spells of loss [s]; 0: none
  double losses = 0.0;             ///< spells of loss, per AUV
  double spread = 0.0;         ///< mean circular variance of the AUVs' bearings around their target
  double near_pairs = 0.0;     ///< pairs nearer than the separation distance, per decision
  double min_altitude = 0.0;   ///< [m]
  double min_clearance = 0.0;  ///< to an obstacle [m]; 1e9: there is none
  double groundings = 0.0;     ///< of all AUVs
  double collisions = 0.0;     ///< with obstacles, of all AUVs
  double packets = 0.0;        ///< received, per AUV
  double packet_loss = 0.0;    ///< share of the packets to each AUV that were lost
  double modem_energy = 0.0;   ///< per AUV [J]
  /// Mechanical energy of a torpedo's shaft, per AUV [J], from the commanded shaft speed and the
  /// speed over ground, because the task does not know the current. 0 for vehicles without a
  /// propeller.
  double propulsion_energy = 0.0;

  std::vector<std::pair<std::string, double>> Items() const;
};

/// Metrics of one episode (Table S1, and further ones). Tail: the
/// last tail_steps decisions. Means over AUVs and decisions unless named.
struct EpisodeMetrics {
  double episode_return = 0.0;   ///< sum over decisions and AUVs
  double tail_distance = 0.0;    ///< d over the tail [m]
  double tracking_error = 0.0;   ///< |d - d*| over the tail [m]
  double lost_rate = 0.0;        ///< share of the tail in which the target is lost (SwarmState)
  double action_norm = 0.0;      ///< norm of tau / tau_max
  double saturation_rate = 0.0;  ///< share of executed action components >= 0.95
  double control_cost = 0.0;     ///< cost of Eq. 35
  double communication_quality = 0.0;  ///< communication term of the reward
  double band_rate = 0.0;              ///< share of the tail inside [d_l, d_u]
  double colliding_pairs = 0.0;        ///< pairs in contact, per decision
  double tail_colliding_pairs = 0.0;
  double min_separation = 0.0;  ///< smallest distance between two AUVs, whole episode [m]
  double time_to_band = 0.0;  ///< first time within d_u, mean over AUVs; never: episode length [s]
  double mean_error = 0.0;    ///< |d - d*| over the whole episode [m]
  double whole_lost_rate = 0.0;  ///< lost over the whole episode
  double reward_track = 0.0, reward_observation = 0.0, reward_coordination = 0.0,
         reward_communication = 0.0, reward_semantic = 0.0, reward_separation = 0.0;
  int steps = 0;
  std::optional<FieldMetrics> field;  ///< in open water

  /// Name and value of every metric, in the order of tables and JSON; those of open water last.
  std::vector<std::pair<std::string, double>> Items() const;
};

/// Whether a metric uses the tail alone, so that an episode without a tail does not define it.
bool OfTail(const std::string& metric);

/// Mean and sample standard deviation of each metric over episodes.
struct MetricSummary {
  std::vector<std::string> names;
  std::vector<double> mean, std;
  int episodes = 0;

  /// Mean of the metric called `name`; 0 if there is none.
  double Mean(const std::string& name) const;
  /// Standard deviation of the metric called `name`; 0 if there is none.
  double Std(const std::string& name) const;
  void Append(const std::string& name, double its_mean, double its_std);
};
MetricSummary Summarise(const std::vector<EpisodeMetrics>& episodes);

}  // namespace stg::task

#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stg_env/task/estimate_metrics.hpp"

namespace stg::task {

/// Of targets that are chosen freely (task.assignment).
struct ChoiceMetrics {
  double switches = 0.0;  ///< changes to another target, per AUV
  /// How far the set of positions that an AUV believes targets to be at is from that of the
  /// targets, mean over AUVs and decisions (DistanceOfSets with a cutoff of 100 m) [m].
  double ospa = 0.0, gospa = 0.0;
};

/// How soon targets are found, how well they are surrounded, and how many of them are followed.
struct SearchMetrics {
  double found = 0.0;           ///< 1: some AUV had an observation of each target
  double time_to_detect = 0.0;  ///< until then, mean over targets; the episode length if never [s]
  double time_to_gather = 0.0;  ///< until all AUVs were in the band at once; the same if never [s]
  /// Mean of 1 - |mean of e^{2 i theta}| over the AUVs' bearings from a target: 0 where all stand
  /// on one line through it, whose ranges tell one axis only.
  double info_spread = 0.0;
  /// Share of targets and decisions with two AUVs in the band, or one where there are not two for
  /// every target, and the best estimate of those that follow it off by less than 20 m in the
  /// plane.
  double followed = 0.0;
  double worst_followed = 0.0;  ///< the same of the target that was followed least
  /// Displacement of the targets over 600 s as a share of their way; 0 in shorter episodes.
  double target_net_speed = 0.0;
  std::optional<ChoiceMetrics> choices;

  std::vector<std::pair<std::string, double>> Items() const;
};

/// Of AUVs that range by pings (sensing.ranging, localization.ranges.by).
struct PingMetrics {
  double pings = 0.0;          ///< that left, per AUV
  double loss = 0.0;           ///< share of them without an answer
  double airtime_share = 0.0;  ///< of the time in which an AUV's modem sends, packets included
};

/// Metrics of one episode in open water, beside the others; of the whole episode.
struct FieldMetrics {
  double estimate_rmse = 0.0;    ///< of the position in the world, depth included [m]
  double nees = 0.0;             ///< mean normalised square of its error; 3 where it is consistent
  double estimate_known = 0.0;   ///< share of AUV decisions with an estimate
  double information_age = 0.0;  ///< mean age of the newest observation in the estimates [s]
  EstimateMetrics estimates;
  SearchMetrics search;
  std::optional<NavigationMetrics> navigation;  ///< of AUVs with a localizer
  std::optional<PingMetrics> pings;             ///< of AUVs that ping, in environments
  double band_share = 0.0;                      ///< share of AUV decisions inside [d_l, d_u]
  double worst_band_share = 0.0;                ///< of the AUV that was inside least
  double time_lost = 0.0;                       ///< mean over AUVs [s]
  double time_to_reacquire =
      0.0;                     ///< mean length of the spells of loss that ended [s]; 0: none did
  double losses = 0.0;         ///< spells of loss, per AUV
  double spread = 0.0;         ///< mean circular variance of the AUVs' bearings around their target
  double near_pairs = 0.0;     ///< pairs nearer than the separation distance, per decision
  double min_altitude = 0.0;   ///< [m]
  double min_clearance = 0.0;  ///< to an obstacle [m]; 1e9: there is none
  double groundings = 0.0;     ///< of all AUVs
  double collisions = 0.0;     ///< with obstacles, of all AUVs
  double packets = 0.0;        ///< received, per AUV
  double packet_loss = 0.0;    ///< share of those sent to each that was lost
  double modem_energy = 0.0;   ///< per AUV [J]
  /// Of the shaft of a torpedo, mechanical, per AUV [J]: by the shaft speed that is asked for and
  /// the speed over ground, as the judge knows no current. 0 of vehicles without a propeller.
  double propulsion_energy = 0.0;

  std::vector<std::pair<std::string, double>> Items() const;
};

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
  std::optional<FieldMetrics> field;  ///< in open water

  /// Name and value of every metric, in the order of tables and JSON; those of open water last.
  std::vector<std::pair<std::string, double>> Items() const;
};

/// Whether the metric of that name is of the tail alone, and nothing in an episode without one.
bool OfTail(const std::string& metric);

/// Mean and sample standard deviation of each metric over episodes.
struct MetricSummary {
  std::vector<std::string> names;
  std::vector<double> mean, std;
  int episodes = 0;

  /// Mean of the metric called `name`; 0 where there is none.
  double Mean(const std::string& name) const;
  /// Standard deviation of the metric called `name`; 0 where there is none.
  double Std(const std::string& name) const;
  void Append(const std::string& name, double its_mean, double its_std);
};
MetricSummary Summarise(const std::vector<EpisodeMetrics>& episodes);

}  // namespace stg::task

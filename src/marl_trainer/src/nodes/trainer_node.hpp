#pragma once

#include <auv_msgs/EpisodeSummary.h>
#include <ros/node_handle.h>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "auv_common/nodes/health.hpp"
#include "learners/online_learner.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::nodes {

/// Trains on recorded episodes: one update from bags; or live, with one update after the other, and
/// each new policy is loaded into the agents.
///
/// In live training, the world is paused during an update and starts an episode after it, so that
/// no steps are wasted. If no node offers /pause and /reset, episodes with more than one policy are
/// dropped.
class TrainerNode {
 public:
  /// Throws UserError.
  TrainerNode();
  void Spin();

 private:
  void TrainOnBags();
  void TrainLive();
  void Subscribe();
  /// Counts the episodes, and reports the flaws.
  void Count(const std::vector<OnlineLearner::Episode>& episodes);
  void Learn();
  void Print(const learn::RecordedTrainer::Progress& progress) const;

  void OnSummary(const auv_msgs::EpisodeSummary& message);
  /// Loads the policy into agents whose last decision had another one.
  void UpdateAgents();
  bool LoadPolicy(int agent);
  void StartEpisode();
  void PauseWorld(bool pause);
  bool CollectionFull();
  bool SummariesIn() const;
  bool TargetReached() const;
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  Scenario scenario_;
  std::vector<std::string> bags_;
  int episodes_per_update_, updates_, window_;
  double target_lost_rate_;
  std::unique_ptr<OnlineLearner> learner_;

  std::vector<std::uint32_t> collection_;  ///< episodes that the learner keeps for the next update
  learn::RecordingReport recording_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<std::string> agent_policies_;  ///< policy of each agent's last decision; "": unknown
  std::uint32_t first_episode_ = 0;  ///< first episode that the present policy flies from its start
  std::map<std::uint32_t, auv_msgs::EpisodeSummary> summaries_;  ///< of the collection, by episode
  std::deque<double> lost_rates_;                                ///< of the newest used episodes
  ros::WallTime began_, last_load_;
  std::optional<ros::WallTime> full_;  ///< since when the collection is full
  Throttle dropped_;                   ///< for warnings about live episodes that were dropped
  int updates_done_ = 0;
  Health health_;
};

}  // namespace stg::nodes

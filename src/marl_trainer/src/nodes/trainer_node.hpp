#pragma once

#include <auv_msgs/AgentStep.h>
#include <auv_msgs/EpisodeSummary.h>
#include <auv_msgs/StepReport.h>
#include <ros/node_handle.h>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "auv_common/nodes/health.hpp"
#include "marl_trainer/learn/recorded/recorded_trainer.hpp"
#include "record_inlet.hpp"

namespace stg::nodes {

/// Learning over recorded episodes: from bags, one update; or live, update after update, with each
/// new policy loaded into the agents.
///
/// Live, the world stands still during an update and starts an episode after it, so that no step
/// is flown for nothing. Where no node offers /pause and /reset, episodes that more than one policy
/// flew are dropped.
class TrainerNode {
 public:
  /// Throws UserError.
  TrainerNode();
  void Spin();

 private:
  void TrainOnBags();
  void TrainLive();
  void Subscribe();
  /// Adds the episode to the collection, or counts and tells why not.
  void Judge(learn::RecordedEpisode episode);
  void Learn();
  void Print(const learn::RecordedTrainer::Progress& progress) const;

  void OnAgentStep(int agent, const auv_msgs::AgentStep& message);
  void OnReport(const auv_msgs::StepReport& message);
  void OnSummary(const auv_msgs::EpisodeSummary& message);
  /// Loads the policy into agents that last decided with another one.
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
  std::unique_ptr<learn::RecordedTrainer> trainer_;

  std::vector<learn::RecordedEpisode> collection_;
  learn::RecordingReport recording_;
  std::unique_ptr<RecordInlet> inlet_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<std::string> agent_policies_;  ///< with which each agent decided last; "": unknown
  std::uint32_t first_episode_ = 0;          ///< flown by the present policy from its start
  std::map<std::uint32_t, auv_msgs::EpisodeSummary> summaries_;  ///< of the collection, by episode
  std::deque<double> lost_rates_;                                ///< of the newest used episodes
  ros::WallTime began_, last_load_;
  std::optional<ros::WallTime> full_;  ///< since when the collection is
  Throttle dropped_;                   ///< of warnings about episodes that were dropped live
  int updates_done_ = 0;
  Health health_;
};

}  // namespace stg::nodes

#pragma once

#include <ros/node_handle.h>

#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "auv_common/nodes/health.hpp"
#include "auv_common/step/step_tracker.hpp"
#include "auv_common/step/step_window.hpp"
#include "display.hpp"
#include "live_table.hpp"
#include "stg_env/nodes/swarm_frame.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::nodes {

/// Watches the whole swarm, including the true states. It publishes the rewards of every step and
/// the metrics of every episode, and shows a live table in the terminal. No node waits for it
/// except the world: the world waits for the last episode's summary before it ends the run.
class MetricsNode {
 public:
  /// Throws UserError.
  MetricsNode();
  ~MetricsNode();
  /// Throws LostOutput at the end if episodes could not be written to the summary file.
  void Spin();

 private:
  double Work();
  void Subscribe();
  /// True if the message has the scenario's sizes and finite numbers.
  bool Usable(const auv_msgs::SwarmState& message) const;
  bool Usable(const auv_msgs::TaskState& message) const;
  /// Follows the run. Returns false if the message contradicts it.
  bool Follow(const auv_msgs::SwarmState& message);
  /// True for a stamp of the run's steps that is not too far ahead; messages may overtake each
  /// other.
  bool Near(TimeNs stamp) const;
  void OnLinks(const auv_msgs::LinkStates::ConstPtr& message);
  auv_msgs::LinkStates::ConstPtr TakeLinks(TimeNs stamp);
  bool AwaitsLinks(const SwarmFrame& frame);
  void JudgeFrames();
  void SendOverdue();
  void Publish(const EpisodeJudge::Verdict& verdict);
  void OpenSummary(std::uint32_t episode);
  void WriteSummary(const EpisodeJudge::Verdict& verdict);
  void LoseSummary();
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  Scenario scenario_;
  TimeNs period_;  ///< of decisions [ns]
  double patience_s_;
  bool show_table_;
  StepTracker tracker_;
  StepWindow<SwarmFrame> frames_;
  EpisodeJudge judge_;
  LiveTable table_;
  Display display_;
  auv_msgs::LinkStates::ConstPtr newest_links_;
  double now_s_ = 0.0;
  std::map<TimeNs, auv_msgs::LinkStates::ConstPtr> links_;  ///< by the step that they lead to
  TimeNs awaited_ = -1;           ///< stamp of the frame whose links were awaited last
  double awaited_since_s_ = 0.0;  ///< wall time [s]
  std::vector<task::EpisodeMetrics> episodes_;  ///< complete episodes
  std::string file_name_;
  std::ofstream file_;
  EventRate reports_;
  std::uint64_t incomplete_frames_ = 0, lost_summaries_ = 0;
  Refusals refused_swarm_, refused_tasks_;
  ros::Publisher step_report_, summary_;
  std::vector<ros::Subscriber> subscribers_;
  Health health_;
};

}  // namespace stg::nodes

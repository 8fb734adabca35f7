#pragma once

#include <auv_msgs/EpisodeSummary.h>
#include <auv_msgs/LinkStates.h>
#include <auv_msgs/StepReport.h>

#include <memory>
#include <string>
#include <vector>

#include "stg_env/nodes/swarm_frame.hpp"
#include "stg_env/task/task.hpp"

namespace stg::nodes {

/// Judges the run frame by frame: applies the task of the training environment to the true states
/// that the world publishes.
class EpisodeJudge {
 public:
  explicit EpisodeJudge(const task::JudgeConfig& scenario);

  /// Results of one frame. A report belongs to the step that ended at this frame.
  struct Verdict {
    bool has_report = false, has_summary = false;
    auv_msgs::StepReport report;
    auv_msgs::EpisodeSummary summary;
    task::EpisodeMetrics metrics;  ///< of the summary
  };
  /// Frames must come in order of time. A frame without truth ends its episode.
  Verdict Judge(const SwarmFrame& frame);

  /// Present true values, for display.
  const task::Tracking<double>& tracking(int i) const { return task_.tracking(i); }
  std::uint32_t episode() const { return episode_; }
  std::uint32_t step() const { return step_; }
  bool started() const { return started_; }
  /// The policy id of all AUVs. If they differ, the different ids in the order of the AUVs, joined
  /// by `+`.
  std::string policy_id() const;

 private:
  void SetTruth(const SwarmFrame& frame);
  void SetField(const SwarmFrame& frame);
  void SetFollowing(const SwarmFrame& frame);
  /// Takes the numbers of packets that were delivered to all AUVs or lost on the way to them, and
  /// the energy of their modems, in this episode so far. Only used in open water.
  void SetLinks(const auv_msgs::LinkStates& links);
  void TakeWrenches(const auv_msgs::SwarmState& truth);
  void TakeActions(const SwarmFrame& frame);
  task::SwarmState<double> Swarm() const;
  bool Truncated() const { return task_.steps(0) >= scenario_.run.time.episode_steps; }
  std::vector<float> CriticState() const;
  void FillReport(const SwarmFrame& frame, std::vector<float> state, Verdict* verdict) const;
  void FillSummary(const ros::Time& stamp, const task::EpisodeMetrics& metrics,
                   Verdict* verdict) const;

  task::JudgeConfig scenario_;
  task::Task<double> task_;
  // The swarm at the present frame, and the decision before it.
  std::vector<dynamics::VehicleState<double>> vehicles_;
  std::vector<dynamics::TargetState<double>> targets_;
  dynamics::Separations<double> separations_;
  task::Efforts<double> tau_, action_;
  double link_quality_ = 0.0;
  // In open water; otherwise null and empty.
  std::unique_ptr<const dynamics::Seascape> scape_;
  std::unique_ptr<task::Following<double>> following_;  // null: targets are not chosen freely
  std::vector<task::FieldState<double>> field_;
  std::vector<float> state_;  // critic's state at the present frame
  bool started_ = false;      ///< an episode is being judged
  bool complete_ = true;      ///< no step of it is missing
  std::uint32_t episode_ = 0, step_ = 0, deadline_misses_ = 0, channel_misses_ = 0;
  std::uint64_t run_ = 0;
  std::uint64_t seed_ = 0;
  std::vector<std::string> policy_ids_;  ///< by AUV
};

}  // namespace stg::nodes

#pragma once

#include <auv_msgs/AcousticPacket.h>
#include <auv_msgs/AcousticReception.h>
#include <auv_msgs/AgentStep.h>
#include <auv_msgs/LoadPolicy.h>
#include <auv_msgs/SensorFrame.h>
#include <auv_msgs/TaskState.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/node_handle.h>

#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "auv_common/nodes/health.hpp"
#include "auv_common/nodes/on_demand.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_common/step/step_barrier.hpp"
#include "auv_common/step/step_tracker.hpp"
#include "decider_lookup.hpp"
#include "pending_inputs.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::nodes {

/// The mind of one AUV. Hears its own navigation, its own detections and its own modem, nothing
/// else.
///
/// Decides step k when the sensors' frame of t_k is there and the modem's reception window that
/// ends at t_k. A window that does not come within `patience` seconds is given up, and a silent
/// modem is not waited for again before it has spoken. The first step of a run waits for the empty
/// window with which the modem says that it is connected. Of several open steps only the newest is
/// decided. What cannot be true of the run is refused, see StepTracker.
class AgentNode {
 public:
  /// Throws UserError.
  AgentNode();
  void Spin();

 private:
  /// What a step waits for that its sensors have opened.
  enum Party { kModem, kParties };

  double Work();
  void Advertise();
  void OnFrame(const auv_msgs::SensorFrame::ConstPtr& message);
  void OnReception(const auv_msgs::AcousticReception::ConstPtr& message);
  bool OnLoadPolicy(auv_msgs::LoadPolicy::Request& request,
                    auv_msgs::LoadPolicy::Response& response);

  void HearModem();
  void DecideIfDue();
  void ForgetRun();
  void StartEpisode(const auv_msgs::SensorFrame& frame);
  void Decide();
  /// Publishes what the last decision commands.
  void Command();
  /// Publishes what else it has to say: packet, task state and record.
  void ReportDecision();
  /// The last decision as a message; false: there is none, or it is not reported yet.
  bool SetVelocity(geometry_msgs::TwistStamped* message) const;
  bool SetTask(auv_msgs::TaskState* message) const;
  bool SetStep(auv_msgs::AgentStep* message) const;
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  agent::AgentModel model_;
  int id_;
  std::string body_frame_;
  agent::Agent agent_;
  acoustics::Turns turns_;  ///< when the modem lets packets go
  agent::Decider decider_;
  TimeNs period_;  ///< of decisions [ns]
  double patience_s_, report_delay_s_;
  bool explore_;
  bool commands_velocity_, commands_wrench_;
  agent::AgentOutput output_;  ///< of the last decision
  float log_probability_ = 0.0F;
  auv_msgs::SensorFrame::ConstPtr decided_;  ///< what the last decision answers
  bool unreported_ = false;                  ///< the last decision's report has not gone out
  std::string policy_id_;                    ///< of what took it
  ros::WallTime busy_, commanded_;

  auv_msgs::SensorFrame::ConstPtr frame_;  ///< of the open step; null: none is open
  PendingInputs pending_;
  StepTracker tracker_;
  StepBarrier barrier_;
  TimeNs window_ = -1;  ///< clock time at which the newest reception window ended [ns]
  TimeNs start_ = -1;   ///< clock time of the episode's step 0 [ns]
  bool in_episode_ = false;
  std::uint32_t episode_ = 0, sequence_ = 0;
  std::vector<float> observation_;
  float action_[dynamics::kMaxActionSize] = {};

  geometry_msgs::WrenchStamped wrench_message_;
  auv_msgs::AcousticPacket packet_message_;
  ros::Publisher wrench_, packet_;
  OnDemand<geometry_msgs::TwistStamped> velocity_;
  OnDemand<auv_msgs::TaskState> task_;
  OnDemand<auv_msgs::AgentStep> step_;
  std::vector<ros::Subscriber> subscribers_;
  ros::ServiceServer load_policy_;

  EventRate decisions_;
  std::uint64_t skipped_steps_ = 0;
  Refusals refused_frames_;
  Health health_;
};

}  // namespace stg::nodes

#pragma once

#include <auv_msgs/AcousticPacket.h>
#include <auv_msgs/AcousticReception.h>
#include <auv_msgs/AgentStep.h>
#include <auv_msgs/EntityStep.h>
#include <auv_msgs/LoadPolicy.h>
#include <auv_msgs/SensorFrame.h>
#include <auv_msgs/TaskState.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <nav_msgs/OccupancyGrid.h>
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

/// Runs the agent of one AUV. It subscribes only to its own navigation, detections and modem.
///
/// It decides step k when it has the sensor frame of t_k and the modem's reception window that ends
/// at t_k. It waits at most `patience` seconds for a window; after that it does not wait for the
/// modem until the modem sends again. The first step of a run waits for the modem's empty window,
/// which
/// shows that it is connected. Of several open steps it decides only the newest. Inputs that
/// contradict the run are refused, see StepTracker.
class AgentNode {
 public:
  /// Throws UserError.
  AgentNode();
  void Spin();

 private:
  /// Inputs for which a step waits after its sensor frame.
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
  /// Publishes the command of the last decision.
  void Command();
  /// Publishes packet, task state and record of the last decision.
  void ReportDecision();
  /// The last decision as a message; false: there is none, or it is not reported yet.
  bool SetVelocity(geometry_msgs::TwistStamped* message) const;
  bool SetTask(auv_msgs::TaskState* message) const;
  bool SetStep(auv_msgs::AgentStep* message) const;
  /// What the messages about a decision have in common.
  template <class Message>
  bool SetReport(const std::string& frame, Message* message) const;
  /// The last command that was drawn with a policy over entities.
  bool SetEntityStep(auv_msgs::EntityStep* message) const;
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  agent::AgentModel model_;
  int id_;
  std::string body_frame_;
  agent::Agent agent_;
  acoustics::Turns turns_;  ///< when the modem sends packets
  agent::Decider decider_;
  TimeNs period_;  ///< of decisions [ns]
  double patience_s_, report_delay_s_;
  bool explore_;
  bool commands_velocity_, commands_wrench_;
  agent::AgentOutput output_;  ///< of the last decision
  float log_probability_ = 0.0F;
  agent::EntityDecision drawn_;              ///< the last drawn command of a policy over entities
  bool drew_ = false;                        ///< the last decision drew it
  auv_msgs::SensorFrame::ConstPtr decided_;  ///< sensor frame of the last decision
  bool unreported_ = false;                  ///< the last decision is not reported yet
  std::string policy_id_;                    ///< policy of the last decision
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
  OnDemand<auv_msgs::EntityStep> entity_step_;
  OnDemand<nav_msgs::OccupancyGrid> search_map_;
  std::vector<ros::Subscriber> subscribers_;
  ros::ServiceServer load_policy_;

  EventRate decisions_;
  std::uint64_t skipped_steps_ = 0;
  Refusals refused_frames_;
  Health health_;
};

}  // namespace stg::nodes

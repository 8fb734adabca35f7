#pragma once

#include <auv_msgs/AcousticPacket.h>
#include <auv_msgs/AcousticReception.h>
#include <auv_msgs/AgentStep.h>
#include <auv_msgs/LoadPolicy.h>
#include <auv_msgs/SensorSync.h>
#include <auv_msgs/TargetDetection.h>
#include <auv_msgs/TaskState.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>

#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "auv_common/nodes/health.hpp"
#include "decider.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::nodes {

/// The mind of one AUV. Hears its own navigation, its own detections and its own modem, nothing
/// else.
///
/// Decides step k when odometry, sensor_sync and the detections it announces are there for t_k,
/// and the modem's reception window that ends at t_k. A window or detection that does not come
/// within `patience` seconds is given up, and a silent modem is not waited for again before it
/// has spoken. Of several open steps only the newest is decided.
class AgentNode {
 public:
  /// Throws UserError.
  AgentNode();
  void Spin();

 private:
  double Work();
  void OnOdometry(const nav_msgs::Odometry::ConstPtr& message);
  void OnDetection(const auv_msgs::TargetDetection::ConstPtr& message);
  void OnSync(const auv_msgs::SensorSync::ConstPtr& message);
  void OnReception(const auv_msgs::AcousticReception::ConstPtr& message);
  bool OnLoadPolicy(auv_msgs::LoadPolicy::Request& request,
                    auv_msgs::LoadPolicy::Response& response);

  void DecideIfDue();
  void StartEpisode(const auv_msgs::SensorSync& sync);
  void TakeDetections(TimeNs stamp);
  void TakeReceptions(TimeNs stamp);
  void Decide();
  /// Publishes what the last decision commands.
  void Command();
  /// Publishes what else it has to say: packet, task state and record.
  void ReportDecision();
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  agent::AgentConfig scenario_;
  int id_;
  std::string body_frame_;
  agent::Agent agent_;
  acoustics::Turns turns_;  ///< when the modem lets packets go
  std::unique_ptr<const Decider> decider_;
  TimeNs period_;  ///< of decisions [ns]
  double patience_s_, report_delay_s_;
  bool explore_;
  agent::AgentOutput output_;  ///< of the last decision
  float log_probability_ = 0.0F;
  auv_msgs::SensorSync::ConstPtr unreported_;  ///< of the last decision, until it is reported
  ros::WallTime busy_, commanded_;

  nav_msgs::Odometry::ConstPtr odometry_;  ///< newest
  auv_msgs::SensorSync::ConstPtr sync_;    ///< of the open step; null: none is open
  ros::WallTime waiting_since_;            ///< of the oldest step that is open or was skipped
  std::vector<auv_msgs::TargetDetection::ConstPtr> detections_;    ///< not taken yet
  std::vector<auv_msgs::AcousticReception::ConstPtr> receptions_;  ///< not taken yet
  TimeNs window_ = -1;  ///< clock time at which the newest reception window ended [ns]
  bool modem_present_ = true;
  TimeNs start_ = -1;  ///< clock time of the episode's step 0 [ns]
  bool in_episode_ = false;
  std::uint32_t episode_ = 0, sequence_ = 0;
  std::vector<float> observation_;
  float action_[6] = {};

  geometry_msgs::TwistStamped command_message_;
  geometry_msgs::WrenchStamped wrench_message_;
  auv_msgs::AcousticPacket packet_message_;
  auv_msgs::TaskState task_message_;
  auv_msgs::AgentStep step_message_;
  ros::Publisher command_, packet_, task_, step_;
  std::vector<ros::Subscriber> subscribers_;
  ros::ServiceServer load_policy_;

  EventRate decisions_;
  std::uint64_t skipped_steps_ = 0, missing_windows_ = 0, missing_detections_ = 0;
  Refusals refused_odometry_, refused_detections_, refused_receptions_, refused_syncs_;
  Health health_;
};

}  // namespace stg::nodes

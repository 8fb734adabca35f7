#pragma once

#include <auv_msgs/ActuatorCommand.h>
#include <auv_msgs/SensorFrame.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>

#include <memory>
#include <vector>

#include "auv_common/nodes/health.hpp"
#include "auv_dynamics/autopilot/autopilot.hpp"
#include "auv_dynamics/control/waiting_commands.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace stg::nodes {

/// Velocity controller of one AUV. If force and moment command the vehicle (Eqs. 24-26), it answers
/// each desired velocity with the wrench for the odometry of the same stamp, and has no state
/// between steps. Otherwise the vehicle's autopilot answers every odometry with a command for the
/// actuators: at a decision, when the desired velocity has arrived; between decisions, at once. The
/// autopilot's memory is reset in each episode, when the sensor frame of step 0 arrives. A vehicle
/// without a simulator has no such frame: there the memory is reset when the node starts, and when
/// the clock of the odometry goes back.
class ControllerNode {
 public:
  /// Throws UserError.
  ControllerNode();
  void Spin();

 private:
  double Work();
  void OnOdometry(const nav_msgs::Odometry::ConstPtr& message);
  void OnCommand(const geometry_msgs::TwistStamped::ConstPtr& message);
  void OnFrame(const auv_msgs::SensorFrame::ConstPtr& message);
  void Refuse(int commands);
  void Answer();
  void AnswerWithWrench(const dynamics::WaitingCommands::Command& command);
  bool Steerable(const dynamics::WaitingCommands::Command& command) const;
  void AnswerWithActuators(const dynamics::WaitingCommands::Command& command);
  void Begin(TimeNs stamp);
  void Forget();
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  dynamics::WorldScenario scenario_;
  dynamics::VehicleConfig believed_;  ///< the AUV's own model of its vehicle
  int id_;
  std::string body_frame_;
  TimeNs period_;           ///< of decisions
  dynamics::NavState nav_;  ///< newest odometry, with its absolute stamp
  bool has_nav_ = false;
  ros::WallTime busy_;
  dynamics::WaitingCommands waiting_;
  geometry_msgs::WrenchStamped wrench_;
  // For vehicles with an autopilot; otherwise null.
  std::unique_ptr<const dynamics::Autopilot> autopilot_;
  std::vector<double> memory_;  ///< of the autopilot
  TimeNs begins_ = -1;  ///< stamp of the episode's step 0, if its odometry has not arrived yet
  TimeNs began_ = -1;   ///< stamp of the first odometry that was answered with this memory
  auv_msgs::ActuatorCommand actuators_;
  TimeNs framed_ = 0;    ///< stamp of the newest sensor frame
  TimeNs answered_ = 0;  ///< stamp of the newest odometry that was answered
  ros::Subscriber frames_;
  EventRate answers_;
  Refusals refused_odometry_, refused_commands_;
  ros::Publisher publisher_;
  ros::Subscriber odometry_, commands_;
  Health health_;
};

}  // namespace stg::nodes

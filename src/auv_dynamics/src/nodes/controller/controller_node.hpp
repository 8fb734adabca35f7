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

/// Velocity controller of one AUV. Where force and moment command the vehicle (Eqs. 24-26), it
/// answers each desired velocity with the wrench for the odometry of the same stamp, and holds no
/// state between steps. Else the vehicle's autopilot answers every odometry with a command of the
/// actuators: that of a decision when its velocity is in, those until the next decision at once.
/// Its memory begins anew with each episode, of which the sensor frame of step 0 tells; on a
/// vehicle without simulator there is none, and it begins with the node, or when the clock of the
/// odometry goes back.
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
  dynamics::VehicleConfig believed_;  ///< what the AUV takes itself for
  int id_;
  std::string body_frame_;
  TimeNs period_;           ///< of decisions
  dynamics::NavState nav_;  ///< newest odometry, with its absolute stamp
  bool has_nav_ = false;
  ros::WallTime busy_;
  dynamics::WaitingCommands waiting_;
  geometry_msgs::WrenchStamped wrench_;
  // Of vehicles that are steered by autopilots; else null.
  std::unique_ptr<const dynamics::Autopilot> autopilot_;
  std::vector<double> memory_;  ///< of the autopilot
  TimeNs begins_ = -1;          ///< stamp of the episode's step 0, whose odometry is still to come
  TimeNs began_ = -1;           ///< stamp of the first odometry that this memory steered by
  auv_msgs::ActuatorCommand actuators_;
  TimeNs framed_ = 0;    ///< stamp of the newest sensor frame
  TimeNs answered_ = 0;  ///< of the newest odometry that was answered
  ros::Subscriber frames_;
  EventRate answers_;
  Refusals refused_odometry_, refused_commands_;
  ros::Publisher publisher_;
  ros::Subscriber odometry_, commands_;
  Health health_;
};

}  // namespace stg::nodes

#pragma once

#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>

#include "auv_common/nodes/health.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace stg::nodes {

/// Velocity controller of one AUV (Eqs. 24-26): answers each desired velocity with the wrench for
/// the odometry of the same stamp. Holds no state between steps.
class ControllerNode {
 public:
  /// Throws UserError.
  ControllerNode();
  void Spin();

 private:
  double Work();
  void OnOdometry(const nav_msgs::Odometry::ConstPtr& message);
  void OnCommand(const geometry_msgs::TwistStamped::ConstPtr& message);
  void Answer();
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  dynamics::WorldConfig scenario_;
  int id_;
  std::string body_frame_;
  TimeNs period_;           ///< of decisions
  dynamics::NavState nav_;  ///< newest odometry, with its absolute stamp
  bool has_nav_ = false;
  ros::WallTime busy_;
  geometry_msgs::TwistStamped::ConstPtr command_;  ///< newest command; waits for its odometry
  geometry_msgs::WrenchStamped wrench_;
  EventRate answers_;
  Refusals refused_odometry_, refused_commands_;
  ros::Publisher publisher_;
  ros::Subscriber odometry_, commands_;
  Health health_;
};

}  // namespace stg::nodes

#pragma once

#include <nav_msgs/Odometry.h>

#include "auv_common/nodes/conversions.hpp"
#include "auv_dynamics/measurements.hpp"

/// Between the vehicles' plain data and messages.
namespace stg::nodes {

/// Pose in `world`, twist in body axes (REP 103).
inline void SetNavigation(const dynamics::NavState& nav, geometry_msgs::Pose* pose,
                          geometry_msgs::Twist* twist) {
  SetVector(nav.p_WB, &pose->position);
  pose->orientation.w = nav.q_WB[0];
  pose->orientation.x = nav.q_WB[1];
  pose->orientation.y = nav.q_WB[2];
  pose->orientation.z = nav.q_WB[3];
  SetVector(nav.v_WB_B, &twist->linear);
  SetVector(nav.w_WB_B, &twist->angular);
}

/// The inverse of SetNavigation, at a time since the episode's step 0.
inline dynamics::NavState NavOf(const geometry_msgs::Pose& pose, const geometry_msgs::Twist& twist,
                                TimeNs stamp) {
  dynamics::NavState nav;
  nav.stamp = stamp;
  nav.p_WB = VectorOf(pose.position);
  nav.q_WB[0] = pose.orientation.w;
  nav.q_WB[1] = pose.orientation.x;
  nav.q_WB[2] = pose.orientation.y;
  nav.q_WB[3] = pose.orientation.z;
  nav.v_WB_B = VectorOf(twist.linear);
  nav.w_WB_B = VectorOf(twist.angular);
  return nav;
}

/// The same of an odometry message, whose stamp is the clock time.
inline dynamics::NavState NavOf(const nav_msgs::Odometry& m, TimeNs start) {
  return NavOf(m.pose.pose, m.twist.twist, NsOf(m.header.stamp) - start);
}

inline bool FiniteOdometry(const nav_msgs::Odometry& m) {
  return FinitePose(m.pose.pose) && FiniteTwist(m.twist.twist);
}

}  // namespace stg::nodes

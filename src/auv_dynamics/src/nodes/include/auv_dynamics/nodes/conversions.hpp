#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Vector3.h>
#include <nav_msgs/Odometry.h>
#include <ros/time.h>

#include <cmath>

#include "auv_dynamics/measurements.hpp"

/// Between the core's plain data and messages. Doubles and integer nanoseconds pass unchanged, so
/// that a graph of nodes computes the same bits as one process.
namespace stg {

inline TimeNs NsOf(const ros::Time& t) { return static_cast<TimeNs>(t.toNSec()); }
inline ros::Time TimeOf(TimeNs t) { return ros::Time().fromNSec(static_cast<std::uint64_t>(t)); }

template <class Message>
inline Vec3<double> VectorOf(const Message& m) {
  return {m.x, m.y, m.z};
}
template <class Message>
inline void SetVector(const Vec3<double>& v, Message* m) {
  m->x = v.x;
  m->y = v.y;
  m->z = v.z;
}

/// Beyond this a number from outside is a fault, and squares of it spoil what they enter.
inline constexpr double kLargestInput = 1e6;

/// Each of these also refuses numbers beyond kLargestInput.
inline bool Finite(double x) { return std::abs(x) <= kLargestInput; }
template <class Message>
inline bool FiniteVector(const Message& m) {
  return Finite(m.x) && Finite(m.y) && Finite(m.z);
}

/// Pose in `world`, twist in body axes (REP 103); the message's stamp is nav.stamp + start.
inline void SetOdometry(const NavState& nav, TimeNs start, nav_msgs::Odometry* m) {
  m->header.stamp = TimeOf(start + nav.stamp);
  SetVector(nav.p_WB, &m->pose.pose.position);
  m->pose.pose.orientation.w = nav.q_WB[0];
  m->pose.pose.orientation.x = nav.q_WB[1];
  m->pose.pose.orientation.y = nav.q_WB[2];
  m->pose.pose.orientation.z = nav.q_WB[3];
  SetVector(nav.v_WB_B, &m->twist.twist.linear);
  SetVector(nav.w_WB_B, &m->twist.twist.angular);
}

/// Pose in `world`, twist in body axes, at a time since the episode's step 0.
inline NavState NavOf(const geometry_msgs::Pose& pose, const geometry_msgs::Twist& twist,
                      TimeNs stamp) {
  NavState nav;
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

/// The inverse of SetOdometry.
inline NavState NavOf(const nav_msgs::Odometry& m, TimeNs start) {
  return NavOf(m.pose.pose, m.twist.twist, NsOf(m.header.stamp) - start);
}

/// The orientation must be a rotation: a quaternion of length one.
inline bool FinitePose(const geometry_msgs::Pose& m) {
  const auto& q = m.orientation;
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return FiniteVector(m.position) && std::abs(length - 1.0) <= 1e-3;
}
inline bool FiniteTwist(const geometry_msgs::Twist& m) {
  return FiniteVector(m.linear) && FiniteVector(m.angular);
}
inline bool FiniteOdometry(const nav_msgs::Odometry& m) {
  return FinitePose(m.pose.pose) && FiniteTwist(m.twist.twist);
}

}  // namespace stg

#pragma once

#include <auv_msgs/TargetDetection.h>
#include <nav_msgs/Odometry.h>

#include <cmath>

#include "auv_common/nodes/conversions.hpp"
#include "auv_dynamics/measurements.hpp"

/// Conversions between the plain data of vehicles and messages.
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

/// The inverse of SetNavigation. @param stamp time since the episode's step 0
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

/// The same for an odometry message, whose stamp is the clock time.
inline dynamics::NavState NavOf(const nav_msgs::Odometry& m, TimeNs start) {
  return NavOf(m.pose.pose, m.twist.twist, NsOf(m.header.stamp) - start);
}

/// Writes the stated deviations as the covariance of a pose. It is row-major 6 x 6; values that are
/// not stated are zero.
inline void SetCovariance(const dynamics::NavState& nav, geometry_msgs::PoseWithCovariance* pose) {
  pose->covariance[0] = pose->covariance[7] = nav.position_std_m * nav.position_std_m;
  pose->covariance[35] = nav.heading_std_rad * nav.heading_std_rad;
}

/// Writes everything except the header.
inline void SetDetection(const dynamics::Detection& d, auv_msgs::TargetDetection* m) {
  const Vec3<double> r = d.p_WT - d.p_WO;
  const double variance = d.std_m * d.std_m;
  const bool position = d.kind == dynamics::MeasurementKind::kPosition;
  m->target = d.target == dynamics::kUnlabelled ? auv_msgs::TargetDetection::UNLABELLED
                                                : static_cast<std::uint32_t>(d.target);
  m->kind = static_cast<std::uint8_t>(d.kind);
  SetVector(r, &m->relative_position);
  SetVector(d.p_WT, &m->position);
  SetVector({variance, variance, variance}, &m->variance);
  m->range = position ? Norm(r) : d.range_m;
  SetVector(d.p_WO, &m->observer);
  m->observer_std = d.p_WO_std_m;
  m->heading_std = d.heading_std_rad;
  m->range_std = d.range_std_m;
  m->azimuth = d.azimuth_rad;
  m->elevation = d.elevation_rad;
  m->bearing_std = d.bearing_std_rad;
  m->ambiguous = d.ambiguous;
  m->mirror_azimuth = d.mirror_azimuth_rad;
}

/// True if a filter can use the result of DetectionOf.
inline bool UsableDetection(const auv_msgs::TargetDetection& m) {
  return m.kind <= auv_msgs::TargetDetection::RANGE_BEARING && FiniteVector(m.position) &&
         FiniteSquare(m.variance.x) && FiniteSquare(m.variance.y) && FiniteSquare(m.variance.z) &&
         m.variance.x >= 0.0 && FiniteVector(m.observer) && Finite(m.range) && m.range >= 0.0 &&
         Finite(m.range_std) && m.range_std >= 0.0 && Finite(m.observer_std) &&
         m.observer_std >= 0.0 && Finite(m.heading_std) && m.heading_std >= 0.0 &&
         Finite(m.azimuth) && Finite(m.elevation) && Finite(m.bearing_std) &&
         m.bearing_std >= 0.0 && Finite(m.mirror_azimuth);
}

/// The inverse of SetDetection; the stamp is the clock time.
inline dynamics::Detection DetectionOf(const auv_msgs::TargetDetection& m) {
  dynamics::Detection d;
  d.stamp = NsOf(m.header.stamp);
  d.target = m.target == auv_msgs::TargetDetection::UNLABELLED ? dynamics::kUnlabelled
                                                               : static_cast<int>(m.target);
  d.p_WT = VectorOf(m.position);
  d.std_m = std::sqrt(m.variance.x);
  d.kind = static_cast<dynamics::MeasurementKind>(m.kind);
  d.p_WO = VectorOf(m.observer);
  d.p_WO_std_m = m.observer_std;
  d.heading_std_rad = m.heading_std;
  d.range_m = m.range;
  d.range_std_m = m.range_std;
  d.azimuth_rad = m.azimuth;
  d.elevation_rad = m.elevation;
  d.bearing_std_rad = m.bearing_std;
  d.ambiguous = m.ambiguous;
  d.mirror_azimuth_rad = m.mirror_azimuth;
  return d;
}

inline bool FiniteOdometry(const nav_msgs::Odometry& m) {
  return FinitePose(m.pose.pose) && FiniteTwist(m.twist.twist);
}

}  // namespace stg::nodes

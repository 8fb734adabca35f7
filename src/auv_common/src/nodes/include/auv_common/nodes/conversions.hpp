#pragma once

#include <ros/time.h>

#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/vector.hpp"
#include "auv_common/step/step_tracker.hpp"
#include "auv_common/time.hpp"

/// Conversions between the core's plain data and messages. Doubles and integer nanoseconds are not
/// changed, so a graph of nodes computes the same bits as one process.
namespace stg::nodes {

inline TimeNs NsOf(const ros::Time& t) { return static_cast<TimeNs>(t.toNSec()); }
/// True for a stamp that a run can have: times computed from it fit into the 32 bits of ROS.
inline bool PossibleStamp(const ros::Time& t) { return NsOf(t) <= StepTracker::kLatest; }
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

/// A larger number from outside is an error; its square would spoil other results.
inline constexpr double kLargestInput = 1e6;

/// The functions below also refuse numbers beyond kLargestInput.
inline bool Finite(double x) { return std::abs(x) <= kLargestInput; }
/// For a variance or a covariance, the square of such numbers.
inline bool FiniteSquare(double x) { return std::abs(x) <= kLargestInput * kLargestInput; }
template <class Message>
inline bool FiniteVector(const Message& m) {
  return Finite(m.x) && Finite(m.y) && Finite(m.z);
}

/// The orientation must be a quaternion of length one.
template <class Pose>
inline bool FinitePose(const Pose& m) {
  const auto& q = m.orientation;
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return FiniteVector(m.position) && std::abs(length - 1.0) <= 1e-3;
}
template <class Twist>
inline bool FiniteTwist(const Twist& m) {
  return FiniteVector(m.linear) && FiniteVector(m.angular);
}

/// Attitude of a body in the world.
template <class Pose>
inline Mat3<double> AttitudeOf(const Pose& pose) {
  const double q[4] = {pose.orientation.w, pose.orientation.x, pose.orientation.y,
                       pose.orientation.z};
  return RotationOf(q);
}

/// Velocity in the world of a body. The twist is in body axes (REP 103).
template <class Pose, class Twist>
inline Vec3<double> WorldVelocity(const Pose& pose, const Twist& twist) {
  return AttitudeOf(pose) * VectorOf(twist.linear);
}

}  // namespace stg::nodes

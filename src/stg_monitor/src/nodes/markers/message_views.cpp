#include "message_views.hpp"

#include <cmath>

namespace stg::nodes {

bool Finite(const geometry_msgs::Point& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

DetectionView DetectionOf(const auv_msgs::TargetDetection& m) {
  using Kind = auv_msgs::TargetDetection;
  DetectionView d{m.header.stamp.toSec(),
                  m.kind != Kind::BEARING,
                  m.kind != Kind::RANGE,
                  m.range,
                  m.azimuth,
                  m.elevation};
  if (m.kind == Kind::POSITION) {
    const auto& r = m.relative_position;
    d.azimuth_rad = std::atan2(r.y, r.x);
    d.elevation_rad = std::atan2(r.z, std::hypot(r.x, r.y));
  }
  return d;
}

geometry_msgs::Vector3 VelocityOf(const nav_msgs::Odometry& message) {
  const auto& q = message.pose.pose.orientation;
  const auto& v = message.twist.twist.linear;
  const double x = 2 * (q.y * v.z - q.z * v.y), y = 2 * (q.z * v.x - q.x * v.z),
               z = 2 * (q.x * v.y - q.y * v.x);
  geometry_msgs::Vector3 out;
  out.x = v.x + q.w * x + q.y * z - q.z * y;
  out.y = v.y + q.w * y + q.z * x - q.x * z;
  out.z = v.z + q.w * z + q.x * y - q.y * x;
  return out;
}

}  // namespace stg::nodes

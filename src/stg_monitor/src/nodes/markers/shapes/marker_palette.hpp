#pragma once

#include <geometry_msgs/Point.h>
#include <std_msgs/ColorRGBA.h>

#include <algorithm>
#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "swarm_view.hpp"

/// Points and colours of the markers.
namespace stg::nodes {

inline geometry_msgs::Point At(double x, double y, double z) {
  geometry_msgs::Point p;
  p.x = x;
  p.y = y;
  p.z = z;
  return p;
}
inline geometry_msgs::Point Sum(const geometry_msgs::Point& a, const geometry_msgs::Point& b) {
  return At(a.x + b.x, a.y + b.y, a.z + b.z);
}
inline geometry_msgs::Point Between(const geometry_msgs::Point& a, const geometry_msgs::Point& b,
                                    double s) {
  return At(a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.z + s * (b.z - a.z));
}
inline double Distance(const geometry_msgs::Point& a, const geometry_msgs::Point& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

inline std_msgs::ColorRGBA Color(double r, double g, double b, double a = 1.0) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(r);
  c.g = static_cast<float>(g);
  c.b = static_cast<float>(b);
  c.a = static_cast<float>(a);
  return c;
}

inline const char* PhaseName(ShownPhase phase) {
  static const char* const kNames[] = {"search", "approach", "stable", "lost", "no word"};
  return kNames[static_cast<int>(phase)];
}

inline std_msgs::ColorRGBA PhaseColor(ShownPhase phase, double alpha = 1.0) {
  switch (phase) {
    case ShownPhase::kSearch:
      return Color(0.25, 0.55, 1.0, alpha);
    case ShownPhase::kApproach:
      return Color(1.0, 0.65, 0.10, alpha);
    case ShownPhase::kStable:
      return Color(0.20, 0.85, 0.35, alpha);
    case ShownPhase::kLost:
      return Color(0.95, 0.20, 0.20, alpha);
    default:
      return Color(0.6, 0.6, 0.6, alpha);
  }
}

/// Violet for no link, cyan for a perfect link. Red is reserved for lost packets.
inline std_msgs::ColorRGBA QualityColor(double quality) {
  const double q = std::clamp(quality, 0.0, 1.0);
  return Color(0.70 - 0.55 * q, 0.20 + 0.75 * q, 0.65 + 0.30 * q, 0.25 + 0.65 * q);
}

}  // namespace stg::nodes

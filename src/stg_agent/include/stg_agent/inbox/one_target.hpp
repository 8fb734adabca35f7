#pragma once

#include "auv_dynamics/measurements.hpp"
#include "stg_agent/agent_config.hpp"

namespace stg::agent {

/// Tells if one target may have caused two detections, which are ranges or points and not bearings.
/// They fit if they differ by no more than the way of the target in between, the way of the
/// observer (for ranges), and the 99 % bound of their noise.
class OneTarget {
 public:
  explicit OneTarget(const AgentModel& model) : max_speed_mps_(model.target.max_speed_mps) {}

  /// Largest difference of their ranges or points [m].
  double Reach(const dynamics::Detection& a, const dynamics::Detection& b) const;
  bool MayCause(const dynamics::Detection& a, const dynamics::Detection& b) const;

 private:
  double max_speed_mps_;
};

}  // namespace stg::agent

#include "auv_dynamics/targets/steered_motion.hpp"

#include <cmath>

namespace stg::dynamics {

Vec3<double> TurnTowards(const Vec3<double>& v, const Vec3<double>& direction, double angle) {
  const double speed = Norm(v), length = Norm(direction);
  if (speed < 1e-12 || length < 1e-12) return v;
  const Vec3<double> a = v * (1.0 / speed), b = direction * (1.0 / length);
  const double between = std::acos(Clip(Dot(a, b), -1.0, 1.0));
  if (between <= angle) return b * speed;
  Vec3<double> normal = b - a * Dot(a, b);
  double n = Norm(normal);
  if (n < 1e-9) {  // opposite vectors: any perpendicular works
    normal = std::abs(a.z) < 0.9 ? Cross(a, {0.0, 0.0, 1.0}) : Cross(a, {1.0, 0.0, 0.0});
    n = Norm(normal);
  }
  return (a * std::cos(angle) + normal * (std::sin(angle) / n)) * speed;
}

SteeredMotion::SteeredMotion(const MotionSetup& setup)
    : config_(setup.target),
      dt_(setup.dt_s),
      half_extent_(setup.half_extent_m),
      region_(setup.region_m) {}

void SteeredMotion::Step(const EpisodeClocks& clocks,
                         const std::vector<VehicleState<Pack>>& vehicles,
                         std::vector<TargetState<Pack>>* targets) {
  const bool open = open_water();
  const double margin = 0.85 * (open ? region_ : half_extent_);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (size_t k = 0; k < targets->size(); ++k) {
      TargetState<Pack>& t = (*targets)[k];
      const Situation now{lane,
                          static_cast<int>(k),
                          clocks[static_cast<size_t>(lane)],
                          Lane(t.p_WT, lane),
                          Lane(t.v_WT, lane),
                          vehicles};
      const Vec3<double>&p = now.p_WT, &v = now.v_WT;
      const bool near_wall = (std::abs(p.x) > margin && p.x * v.x > 0.0) ||
                             (std::abs(p.y) > margin && p.y * v.y > 0.0) ||
                             (!open && std::abs(p.z) > margin && p.z * v.z > 0.0);
      const Vec3<double> centre{-p.x, -p.y, open ? 0.0 : -p.z};
      Vec3<double> next = near_wall ? TurnTowards(v, centre, largest_turn()) : Steer(now);
      const double speed = Norm(next);
      if (speed > config_.max_speed_mps) next = next * (config_.max_speed_mps / speed);
      SetLane(&t.v_WT, lane, next);
    }
  }
  for (TargetState<Pack>& t : *targets) {
    t.p_WT = Clip(t.p_WT + t.v_WT * Pack(dt_), -half_extent_, half_extent_);
  }
}

}  // namespace stg::dynamics

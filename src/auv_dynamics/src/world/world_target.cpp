#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "auv_dynamics/vehicle/vehicle_model.hpp"
#include "auv_dynamics/world/world.hpp"

namespace stg::dynamics {
namespace {

/// Velocity v turned towards a direction by at most `angle`, at its own speed.
Vec3<double> TurnTowards(const Vec3<double>& v, const Vec3<double>& direction, double angle) {
  const double speed = Norm(v), length = Norm(direction);
  if (speed < 1e-12 || length < 1e-12) return v;
  const Vec3<double> a = v * (1.0 / speed), b = direction * (1.0 / length);
  const double between = std::acos(Clip(Dot(a, b), -1.0, 1.0));
  if (between <= angle) return b * speed;
  Vec3<double> normal = b - a * Dot(a, b);
  double n = Norm(normal);
  if (n < 1e-9) {  // opposite: any perpendicular will do
    normal = std::abs(a.z) < 0.9 ? Cross(a, {0.0, 0.0, 1.0}) : Cross(a, {1.0, 0.0, 0.0});
    n = Norm(normal);
  }
  return (a * std::cos(angle) + normal * (std::sin(angle) / n)) * speed;
}

/// Whether `to`, relative to a target of velocity v, lies inside the circle of
/// its tightest turn: turning towards it would orbit it forever.
bool InsideTurningCircle(const Vec3<double>& v, const Vec3<double>& to, double max_turn_rate) {
  const double speed = Norm(v);
  if (speed < 1e-12) return false;
  const double radius = speed / max_turn_rate;
  const double along = Dot(v, to) * (1.0 / speed);
  const double aside = Norm(to - v * (along / speed)) - radius;
  return along * along + aside * aside < radius * radius;
}

}  // namespace

void World::MoveTargets() {
  const Pack h(scenario_.time.dt_s), limit(scenario_.workspace.half_extent_m);
  if (scenario_.target.motion != TargetMotion::kConstantVelocity) {
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int k = 0; k < targets(); ++k) SteerTarget(lane, k);
    }
  }
  for (auto& t : targets_) {
    t.p_WT += t.v_WT * h;
    if (scenario_.target.motion == TargetMotion::kConstantVelocity) {
      t.v_WT.x = Select(Abs(t.p_WT.x) > limit, -t.v_WT.x, t.v_WT.x);
      t.v_WT.y = Select(Abs(t.p_WT.y) > limit, -t.v_WT.y, t.v_WT.y);
      t.v_WT.z = Select(Abs(t.p_WT.z) > limit, -t.v_WT.z, t.v_WT.z);
    }
    t.p_WT = Clip(t.p_WT, -scenario_.workspace.half_extent_m, scenario_.workspace.half_extent_m);
  }
}

void World::SteerTarget(int lane, int k) {
  const TargetConfig& c = scenario_.target;
  const double dt = scenario_.time.dt_s;
  TargetState<Pack>& t = targets_[static_cast<size_t>(k)];
  const Vec3<double> p = Lane(t.p_WT, lane);
  Vec3<double> v = Lane(t.v_WT, lane);
  const double most = c.max_turn_rate_radps * dt;
  const auto uk = static_cast<std::uint32_t>(k);
  const double margin = 0.85 * scenario_.workspace.half_extent_m;
  const bool near_wall = (std::abs(p.x) > margin && p.x * v.x > 0.0) ||
                         (std::abs(p.y) > margin && p.y * v.y > 0.0) ||
                         (std::abs(p.z) > margin && p.z * v.z > 0.0);
  if (near_wall) {
    v = TurnTowards(v, -p, most);
  } else if (c.motion == TargetMotion::kCoordinatedTurn) {
    const double time = dt * step_[lane];
    Random random(seed_[lane], Stream::kTarget, episode_[lane],
                  static_cast<std::uint32_t>(time / c.turn_period_s), uk);
    const double rate =
        Clip(2.0 * random.Uniform() * c.turn_rate_radps, 0.0, c.max_turn_rate_radps);
    const Vec3<double> axis{random.Normal(), random.Normal(), random.Normal()};
    v = TurnTowards(v, Cross(axis, v), rate * dt);
  } else if (c.motion == TargetMotion::kRandomWaypoint) {
    std::uint32_t& index = waypoint_[static_cast<size_t>(lane * targets() + k)];
    const auto waypoint = [&] {
      Random random(seed_[lane], Stream::kTarget, episode_[lane], index, uk);
      const double e = 0.8 * scenario_.workspace.half_extent_m;
      return Vec3<double>{random.Uniform(-e, e), random.Uniform(-e, e), random.Uniform(-e, e)};
    };
    const Vec3<double> to = waypoint() - p;
    // A point that cannot be reached by turning is given up for the next one.
    if (Norm(to) < c.waypoint_radius_m || InsideTurningCircle(v, to, c.max_turn_rate_radps)) {
      ++index;
    }
    v = TurnTowards(v, waypoint() - p, most);
  } else {  // evasive: away from every vehicle in range, the closer the stronger
    Vec3<double> away;
    double closest = c.evasion_range_m;
    for (int i = 0; i < agents(); ++i) {
      const Vec3<double> r = p - Lane(vehicle(i).p_WB, lane);
      const double d = std::max(Norm(r), 1e-6);
      if (d >= c.evasion_range_m) continue;
      away += r * (1.0 / (d * d));
      closest = std::min(closest, d);
    }
    if (closest < c.evasion_range_m) v = TurnTowards(v, away, most);
  }
  const double speed = Norm(v);
  if (speed > c.max_speed_mps) v = v * (c.max_speed_mps / speed);
  SetLane(&t.v_WT, lane, v);
}

}  // namespace stg::dynamics

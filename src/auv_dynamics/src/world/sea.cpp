#include "auv_dynamics/world/sea.hpp"

#include <algorithm>

namespace stg::dynamics {
namespace {

/// Smallest distance of targets from the bottom [m].
constexpr double kTargetAltitude_m = 5.0;

/// Removes the part of a velocity that leads into an obstacle. Its surface points along `out`.
Vec3<double> Along(const Vec3<double>& v, const Vec3<double>& out) {
  return v - out * std::min(0.0, Dot(v, out));
}

}  // namespace

Sea::Sea(const SeaConfig& config, int vehicles, double region_m)
    : config_(config),
      scape_(config, region_m),
      groundings_(static_cast<std::size_t>(vehicles), Pack(0.0)),
      aground_(groundings_),
      collisions_(groundings_),
      touching_(groundings_) {}

void Sea::Reset(int lane) {
  for (auto* values : {&groundings_, &aground_, &collisions_, &touching_}) {
    for (Pack& x : *values) SetLane(&x, lane, 0.0);
  }
}

Pack Sea::Bottom(const Vec3<Pack>& p_WB) const {
  if (terrain().flat()) return Pack(-config_.bottom_m);
  Pack bottom(0.0);
  for (int lane = 0; lane < kLanes; ++lane) {
    SetLane(&bottom, lane, terrain().Height(Lane(p_WB.x, lane), Lane(p_WB.y, lane)));
  }
  return bottom;
}

void Sea::Apply(int i, VehicleState<Pack>* s) {
  if (!scape_.obstacles.empty()) MeetObstacles(i, s);
  const Pack zero(0.0), one(1.0), bottom = Bottom(s->p_WB);
  const auto below = s->p_WB.z < bottom;
  const auto above = s->p_WB.z > zero;
  Pack& aground = aground_[static_cast<std::size_t>(i)];
  Pack& groundings = groundings_[static_cast<std::size_t>(i)];
  // A vehicle that stays on the bottom remains aground. Only a new contact counts.
  const auto on = below || (s->p_WB.z == bottom && aground > zero);
  groundings += Select(below, one - aground, zero);
  aground = Select(on, one, zero);
  if (!Any(below || above)) return;
  s->p_WB.z = Min(Max(s->p_WB.z, bottom), zero);
  const Pack climb = s->v_WB.z;
  s->v_WB.z = Select(below, Max(climb, zero), Select(above, Min(climb, zero), climb));
  s->v_WB_B = Select(below || above, s->R_WB.TransposeTimes(s->v_WB), s->v_WB_B);
}

void Sea::MeetObstacles(int i, VehicleState<Pack>* s) {
  const auto u = static_cast<std::size_t>(i);
  Pack met(0.0);
  for (const Obstacle& o : scape_.obstacles) {
    const Pack inside = o.Inside(s->p_WB);
    if (!Any(inside > Pack(0.0))) continue;
    for (int lane = 0; lane < kLanes; ++lane) {
      if (Lane(inside, lane) == 0.0) continue;
      Vec3<double> p = Lane(s->p_WB, lane);
      const Vec3<double> v = Along(Lane(s->v_WB, lane), o.Expel(&p));
      SetLane(&s->p_WB, lane, p);
      SetLane(&s->v_WB, lane, v);
      SetLane(&met, lane, 1.0);
    }
  }
  const Pack zero(0.0), one(1.0);
  collisions_[u] += Select(met > touching_[u], one, zero);
  touching_[u] = met;
  if (!Any(met > zero)) return;
  s->v_WB_B = Select(met > zero, s->R_WB.TransposeTimes(s->v_WB), s->v_WB_B);
}

void Sea::Apply(std::vector<TargetState<Pack>>* targets) const {
  const Pack lo(-config_.target_depth_m.hi), hi(-config_.target_depth_m.lo), zero(0.0);
  for (TargetState<Pack>& t : *targets) {
    const auto outward = (t.p_WT.z < lo && t.v_WT.z < zero) || (t.p_WT.z > hi && t.v_WT.z > zero);
    t.p_WT.z = Min(Max(t.p_WT.z, lo), hi);
    // The vertical velocity is reversed, and the target's motion continues from there.
    t.v_WT.z = Select(outward, -t.v_WT.z, t.v_WT.z);
    if (scape_.clear()) continue;
    const Pack floor = Bottom(t.p_WT) + Pack(kTargetAltitude_m);
    t.p_WT.z = Min(Max(t.p_WT.z, floor), zero);
    for (const Obstacle& o : scape_.obstacles) {
      const Pack inside = o.Inside(t.p_WT);
      for (int lane = 0; lane < kLanes; ++lane) {
        if (Lane(inside, lane) == 0.0) continue;
        Vec3<double> p = Lane(t.p_WT, lane);
        const Vec3<double> before = Lane(t.v_WT, lane);
        const Vec3<double> v = Along(before, o.Expel(&p));
        SetLane(&t.p_WT, lane, p);
        // The target slides along at its own speed. If it comes at right angles, it turns aside.
        const double speed = Norm(before), left = Norm(v);
        SetLane(
            &t.v_WT, lane,
            left > 0.01 * speed ? v * (speed / left) : Vec3<double>{-before.y, before.x, before.z});
      }
    }
  }
}

}  // namespace stg::dynamics

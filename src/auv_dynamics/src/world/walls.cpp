#include "auv_dynamics/world/walls.hpp"

namespace stg::dynamics {

void Walls::Apply(VehicleState<Pack>* s) const {
  const WorkspaceConfig& c = config_;
  const Pack limit(c.half_extent_m), zero(0.0), one(1.0);
  const auto hit_x = Abs(s->p_WB.x) > limit;
  const auto hit_y = Abs(s->p_WB.y) > limit;
  const auto hit_z = Abs(s->p_WB.z) > limit;
  const auto hit = hit_x || hit_y || hit_z;
  if (!Any(hit)) return;
  const Pack tangential(c.tangential);
  const auto reflect = [&](const Pack& p, const Pack& v) {
    // Outward velocity is reflected. A vehicle that moves inward already keeps its velocity.
    return Select(p * v > zero, -v * Pack(c.restitution), v);
  };
  Vec3<Pack> v = s->v_WB;
  v.x = Select(hit_x, reflect(s->p_WB.x, v.x), v.x);
  v.y = Select(hit_x, v.y * tangential, v.y);
  v.z = Select(hit_x, v.z * tangential, v.z);
  v.y = Select(hit_y, reflect(s->p_WB.y, v.y), v.y);
  v.x = Select(hit_y, v.x * tangential, v.x);
  v.z = Select(hit_y, v.z * tangential, v.z);
  v.z = Select(hit_z, reflect(s->p_WB.z, v.z), v.z);
  v.x = Select(hit_z, v.x * tangential, v.x);
  v.y = Select(hit_z, v.y * tangential, v.y);
  s->v_WB = v;
  s->p_WB = Clip(s->p_WB, -c.half_extent_m, c.half_extent_m);
  s->v_WB_B = s->v_WB_B * Select(hit, Pack(c.body_velocity), one);
  s->w_WB_B = s->w_WB_B * Select(hit, Pack(c.body_rate), one);
}

}  // namespace stg::dynamics

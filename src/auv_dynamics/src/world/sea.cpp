#include "auv_dynamics/world/sea.hpp"

namespace stg::dynamics {

using config::kNone;
using config::NonNegative;
using config::Positive;

void Describe(SeaConfig* c, config::Table* t) {
  t->Section("sea");
  t->AddOptional("open", &c->open, "false", kNone, "-",
                 "open water: a surface at z = 0 and a bottom instead of the walls");
  t->AddOptional("bottom_m", &c->bottom_m, "120.0", Positive(12000), "m",
                 "depth of the flat bottom");
  t->AddOptional("auv_depth_m", &c->auv_depth_m, "[20.0, 60.0]", NonNegative(12000), "m",
                 "[low, high] depth at which an AUV starts in open water");
  t->AddOptional("target_depth_m", &c->target_depth_m, "[20.0, 60.0]", NonNegative(12000), "m",
                 "[low, high] depth at which a target starts and stays in open water");
}

std::optional<config::Violation> FindConflict(const SeaConfig& c) {
  if (!c.open) return {};
  if (c.auv_depth_m.hi >= c.bottom_m) {
    return config::Violation{{"sea.auv_depth_m", "sea.bottom_m"}, "AUVs would start in the bottom"};
  }
  if (c.target_depth_m.hi >= c.bottom_m) {
    return config::Violation{{"sea.target_depth_m", "sea.bottom_m"},
                             "targets would start in the bottom"};
  }
  return {};
}

Sea::Sea(const SeaConfig& config, int vehicles)
    : config_(config),
      groundings_(static_cast<std::size_t>(vehicles), Pack(0.0)),
      aground_(groundings_) {}

void Sea::Reset(int lane) {
  for (Pack& x : groundings_) SetLane(&x, lane, 0.0);
  for (Pack& x : aground_) SetLane(&x, lane, 0.0);
}

void Sea::Apply(int i, VehicleState<Pack>* s) {
  const Pack zero(0.0), one(1.0), bottom(-config_.bottom_m);
  const auto below = s->p_WB.z < bottom;
  const auto above = s->p_WB.z > zero;
  Pack& aground = aground_[static_cast<std::size_t>(i)];
  Pack& groundings = groundings_[static_cast<std::size_t>(i)];
  // Who lies on the bottom and does not rise stays aground; only coming there counts.
  const auto on = below || (s->p_WB.z == bottom && aground > zero);
  groundings += Select(below, one - aground, zero);
  aground = Select(on, one, zero);
  if (!Any(below || above)) return;
  s->p_WB.z = Min(Max(s->p_WB.z, bottom), zero);
  const Pack climb = s->v_WB.z;
  s->v_WB.z = Select(below, Max(climb, zero), Select(above, Min(climb, zero), climb));
  s->v_WB_B = Select(below || above, s->R_WB.TransposeTimes(s->v_WB), s->v_WB_B);
}

void Sea::Apply(std::vector<TargetState<Pack>>* targets) const {
  const Pack lo(-config_.target_depth_m.hi), hi(-config_.target_depth_m.lo), zero(0.0);
  for (TargetState<Pack>& t : *targets) {
    const auto outward = (t.p_WT.z < lo && t.v_WT.z < zero) || (t.p_WT.z > hi && t.v_WT.z > zero);
    t.p_WT.z = Min(Max(t.p_WT.z, lo), hi);
    // It levels out, and its motion steers on from there.
    t.v_WT.z = Select(outward, -t.v_WT.z, t.v_WT.z);
  }
}

}  // namespace stg::dynamics

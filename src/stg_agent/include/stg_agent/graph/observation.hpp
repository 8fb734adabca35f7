#pragma once

#include <cassert>

#include "stg_agent/agent_config.hpp"
#include "stg_agent/graph/features.hpp"
#include "stg_agent/graph/knowledge.hpp"

/// The policy input of Eq. 20: raw physical state and the features of features.hpp, from an AUV's
/// knowledge. One template serves the truth mode (T = Pack, knowledge from true states) and an
/// agent (own knowledge only).
namespace stg::agent {

/// First index of the own position and of the target offset, both in half extents of the workspace.
inline constexpr int kOwnPositionIndex =
    ObservationSpec(ObservationConfig()).offset(Block::kPosition);
inline constexpr int kTargetOffsetIndex =
    ObservationSpec(ObservationConfig()).offset(Block::kTargetOffset);

/// Writes the observation through put(index, value), index 0 .. observation_size() - 1 in
/// ascending order; ObservationSpec gives the place of each block.
template <class T, class Put>
inline void BuildObservation(const AgentModel& model, const Knowledge<T>& k, Put&& put) {
  const ObservationConfig& c = model.observation;
  const ObservationSpec spec(c);
  const auto& vm = model.vehicle.max_velocity_mps;
  const auto& wm = model.vehicle.max_rate_radps;
  const Vec3<double> inv_v{1.0 / vm[0], 1.0 / vm[1], 1.0 / vm[2]};
  const Vec3<double> inv_w{1.0 / wm[0], 1.0 / wm[1], 1.0 / wm[2]};
  const T one(1.0), inv_extent(1.0 / model.workspace.half_extent_m);
  int n = 0;
  const auto begin = [&](Block block) {
    assert(n == spec.offset(block));
    (void)block;
  };
  const auto put3 = [&](const Vec3<T>& v) __attribute__((always_inline)) {
    put(n, v.x);
    put(n + 1, v.y);
    put(n + 2, v.z);
    n += 3;
  };
  const Vec3<T> u = k.v_WT - k.v_WB;  // Eq. 11
  const Vec3<T> p = k.p_WB * inv_extent;
  begin(Block::kPosition);
  put3(Clip(p, -2.0, 2.0));
  begin(Block::kAttitude);
  put3({k.trig.sin_phi, k.trig.cos_phi, k.trig.sin_theta});
  put3({k.trig.cos_theta, k.trig.sin_psi, k.trig.cos_psi});
  begin(Block::kVelocity);
  put3(Scale(k.v_WB_B, inv_v));
  begin(Block::kRates);
  put3(Scale(k.w_WB_B, inv_w));
  begin(Block::kTargetOffset);
  put3(Clip(k.r_BT_W * inv_extent, -2.0, 2.0));
  begin(Block::kNeighbours);
  for (const auto& r : k.neighbour) put3(Clip(r * inv_extent, -2.0, 2.0));
  begin(Block::kWallRoom);
  put3(Clip(Vec3<T>{one - Abs(p.x), one - Abs(p.y), one - Abs(p.z)}, -1.0, 1.0));
  begin(Block::kTargetVelocity);
  put3(Scale(k.v_WT, inv_v));
  begin(Block::kRelativeVelocity);
  put3(Clip(Scale(u, inv_v), -2.0, 2.0));
  begin(Block::kTargetOffsetBody);
  put3(Clip(k.R_WB.TransposeTimes(k.r_BT_W) * inv_extent, -2.0, 2.0));
  begin(Block::kRelativeVelocityBody);
  put3(Clip(Scale(k.R_WB.TransposeTimes(u), inv_v), -2.0, 2.0));
  begin(Block::kLineOfSight);
  put3(k.R_WB.TransposeTimes(k.r_BT_W) * (one / Max(k.distance, T(1e-9))));
  begin(Block::kForce);
  for (const T& value : k.tau) put(n++, value);
  if (c.tracking) {
    begin(Block::kTracking);
    T z[kTrackingNumbers];
    TrackingVector(c, k, &z);
    for (const T& value : z) put(n++, value);
  }
  if (c.semantic) {
    T phase[kPhases], quality[kQualities];
    PhaseOneHot(c, k.lost, k.distance, ShownProgress(c, k), &phase);
    QualityOneHot(c, k.confidence, &quality);
    begin(Block::kPhase);
    for (const T& value : phase) put(n++, value);
    begin(Block::kQuality);
    for (const T& value : quality) put(n++, value);
    begin(Block::kClosest);
    put(n++, k.closest);
  }
  if (c.graph) {
    begin(Block::kGraph);
    T graph[kGraphNumbers];
    GraphSummary(c, k, &graph);
    for (const T& value : graph) put(n++, value);
  }
}

}  // namespace stg::agent

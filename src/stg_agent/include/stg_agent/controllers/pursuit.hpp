#pragma once

#include <algorithm>
#include <memory>

#include "auv_common/numbers/vector.hpp"
#include "stg_agent/controllers/controller.hpp"

/// Controllers that fly at the target: `pursuit`, and `pursuit_separated`, whose AUVs keep apart.
namespace stg::agent {

/// Constants of the pursuit law; the defaults are the tuned ones of `pursuit`.
struct PursuitOptions {
  double gain_per_s = 4.66;
  double standoff_m = 0.009;
  double cap = 0.75;                  ///< share of the maximum speed, each axis
  double repulsion_gain_per_s = 0.0;  ///< 0: neighbours are ignored
  double repulsion_range_m = 0.03;    ///< neighbours closer than this repel
  double tangential_range_m = 0.05;   ///< closer to the target, repulsion only acts sideways
  /// Share of the target's velocity that is added. A value above 1 compensates for the speed that
  /// the proportional velocity loop (Eq. 24) loses to drag.
  double feedforward = 1.0;
  /// Upper limit of gain (d - standoff): approach_speed + approach_gain (d - standoff). It makes
  /// the approach slow and keeps the hold stiff. Both 0: no such limit.
  double approach_speed_mps = 0.0;
  double approach_gain_per_s = 0.0;
  /// A target closer to a wall than this is treated as if it were at this distance. At the wall,
  /// the AUVs would have only half a sphere to spread over, and four of them would touch. 0: off.
  double wall_margin_m = 0.0;
};

void Describe(PursuitOptions* o, config::Table* t);

/// The same, tuned so that AUVs keep apart.
struct PursuitSeparatedOptions : PursuitOptions {
  PursuitSeparatedOptions() {
    gain_per_s = 3.0;
    standoff_m = 0.0142;
    repulsion_gain_per_s = 2.0;
  }
};

/// Pursuit: v = gain (d - standoff) los + feedforward v_T, plus, from each neighbour closer than
/// the repulsion range s0, gain_r (s0 - s) away from it. Within tangential_range_m of the target
/// the repulsion along the line of sight is left out, so that AUVs spread over the sphere around
/// the target and keep their distance to it. The result is clipped per axis. Writes the action v /
/// v_max (Eq. 23 inverted), three numbers in [-cap, cap].
///
/// @param r_BT_W target position minus own [m], world axes
/// @param v_WT   target velocity [m/s], world axes
/// @param neighbours [count], of which the offset is used; a zero offset has no effect
template <class T>
inline void PursuitAction(const PursuitOptions& o, const dynamics::VehicleConfig& vehicle,
                          const Vec3<T>& r_BT_W, const Vec3<T>& v_WT,
                          const NeighbourSight<T>* neighbours, int count, T* action) {
  const T zero(0.0), tiny(1e-9);
  const T d = Norm(r_BT_W);
  const Vec3<T> los = r_BT_W * (T(1.0) / Max(d, tiny));
  const T error = d - T(o.standoff_m);
  T speed = T(o.gain_per_s) * error;
  if (o.approach_speed_mps > 0.0 || o.approach_gain_per_s > 0.0) {
    speed = Min(speed, T(o.approach_speed_mps) + T(o.approach_gain_per_s) * Max(error, zero));
  }
  Vec3<T> v = los * speed + v_WT * T(o.feedforward);
  if (o.repulsion_gain_per_s > 0.0) {
    Vec3<T> push;
    for (int j = 0; j < count; ++j) {
      const Vec3<T>& r_BN_W = neighbours[j].r_BN_W;
      const T s = Norm(r_BN_W);
      const T strength = T(o.repulsion_gain_per_s) * Max(T(o.repulsion_range_m) - s, zero);
      push += r_BN_W * (-strength / Max(s, tiny));
    }
    const Vec3<T> tangential = push - los * Dot(push, los);
    v += Select<T>(d < T(o.tangential_range_m), tangential, push);
  }
  const auto& vmax = vehicle.max_velocity_mps;
  action[0] = Clip(v.x * T(1.0 / vmax[0]), T(-o.cap), T(o.cap));
  action[1] = Clip(v.y * T(1.0 / vmax[1]), T(-o.cap), T(o.cap));
  action[2] = Clip(v.z * T(1.0 / vmax[2]), T(-o.cap), T(o.cap));
}

/// Moves a target that is closer to a wall than the margin to the margin, and sets its velocity
/// normal to that wall to zero.
template <class T>
inline void KeepFromWalls(double wall_m, double margin_m, const Vec3<T>& p_WB, Vec3<T>* r_BT_W,
                          Vec3<T>* v_WT) {
  if (margin_m <= 0.0) return;
  const T limit(std::max(wall_m - margin_m, 0.0)), zero(0.0);
  const auto keep = [&](const T& own, T* offset, T* velocity) {
    const T position = own + *offset;
    *velocity = Select(limit < Abs(position), zero, *velocity);
    *offset = Clip(position, -limit, limit) - own;
  };
  keep(p_WB.x, &r_BT_W->x, &v_WT->x);
  keep(p_WB.y, &r_BT_W->y, &v_WT->y);
  keep(p_WB.z, &r_BT_W->z, &v_WT->z);
}

/// The same from an agent's knowledge, true or estimated, with KeepFromWalls applied to the target.
template <class T>
inline void PursuitAction(const PursuitOptions& o, const AgentModel& model, const Knowledge<T>& k,
                          const NeighbourSight<T>* neighbours, int count, T* action) {
  Vec3<T> r_BT_W = k.r_BT_W, v_WT = k.v_WT;
  KeepFromWalls(model.wall_m(), o.wall_margin_m, k.p_WB, &r_BT_W, &v_WT);
  PursuitAction(o, model.vehicle, r_BT_W, v_WT, neighbours, count, action);
}

/// The pursuit law, from any knowledge.
struct Pursuit {
  PursuitOptions options;

  template <class T>
  void Act(const ControllerInput<T>& in, T* action) const {
    T velocity[3];
    PursuitAction(options, in.model, in.knowledge, in.neighbours, in.neighbour_count, velocity);
    AskForVelocity(in, velocity, action);
  }
};

std::unique_ptr<Controller> MakePursuit(const PursuitOptions& options);
std::unique_ptr<Controller> MakePursuitSeparated(const PursuitSeparatedOptions& options);

}  // namespace stg::agent

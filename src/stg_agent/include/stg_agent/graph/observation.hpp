#pragma once

#include "auv_common/numbers/attitude.hpp"
#include "stg_agent/agent/agent_config.hpp"

/// The policy input of Eq. 20 from what one AUV knows: raw physical state, the
/// tracking diagnostics of Eq. 14, the phase and quality of Eqs. 15-16 and the
/// task-graph summary of Eq. 18. One template serves the truth mode (T = Pack,
/// knowledge from true states) and an agent (T = double, own knowledge only).
namespace stg::agent {

inline constexpr int kNeighbourSlots = 3;
inline constexpr int kRawSize = 51;
/// Where own position and target offset begin, both by the half extent of the workspace.
inline constexpr int kOwnPositionIndex = 0, kTargetOffsetIndex = 15;

enum Phase { kSearch = 0, kApproach = 1, kStable = 2, kLost = 3 };
enum Quality { kHigh = 0, kMedium = 1, kLow = 2, kUnavailable = 3 };

/// What one AUV knows at a decision. Lengths [m], world axes unless named.
template <class T>
struct Knowledge {
  // Own navigation.
  Vec3<T> p_WB, v_WB, v_WB_B, w_WB_B;
  Mat3<T> R_WB;
  EulerTrig<T> trig;
  // Target: offset from the AUV (r of Eq. 11) and velocity.
  Vec3<T> r_BT_W, v_WT;
  // Offsets of up to three neighbours; zero where there is none.
  Vec3<T> neighbour[kNeighbourSlots];
  // tau / tau_max of the previous step.
  T tau[6] = {T(0.0), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0)};
  // Tracking (Eqs. 1, 12-14).
  T distance = T(0.0);           ///< d
  T previous_distance = T(0.0);  ///< d of the previous decision
  T error = T(0.0);              ///< e
  T mean_error = T(0.0);         ///< mean of e over the last k decisions
  T closing = T(0.0);            ///< closing speed [m/s], positive when approaching
  T confidence = T(0.0);         ///< c
  T lost = T(0.0);               ///< l, 0 or 1
  T lost_steps = T(0.0);         ///< consecutive decisions lost
  // Task graph (Eqs. 18-19) before normalisation.
  T closest = T(0.0);  ///< 1 when no other AUV is closer to the target
  T effective_fraction = T(0.0), mean_quality = T(0.0), best_quality = T(0.0);
  T mean_neighbour_error = T(0.0);
};

/// The kNeighbourSlots nearest of the neighbours offered one by one, nearest first; of two at
/// the same distance the one offered first.
template <class T>
struct NearestSlots {
  Vec3<T> offset[kNeighbourSlots];  ///< zero where there is none
  T distance[kNeighbourSlots] = {T(1e9), T(1e9), T(1e9)};

  void Offer(Vec3<T> r, T d) {
    // Insertion into the sorted slots, one branch-free exchange each.
    if (!Any(d < distance[kNeighbourSlots - 1])) return;
    for (int slot = 0; slot < kNeighbourSlots; ++slot) {
      const auto closer = d < distance[slot];
      const T d_out = Select(closer, distance[slot], d);
      const Vec3<T> r_out = Select<T>(closer, offset[slot], r);
      distance[slot] = Select(closer, d, distance[slot]);
      offset[slot] = Select<T>(closer, r, offset[slot]);
      d = d_out;
      r = r_out;
    }
  }
};

/// c of Eq. 13.
template <class T>
inline T Confidence(const T& distance, double sensing_range) {
  return Clip(T(1.0) - distance * T(1.0 / sensing_range), T(0.0), T(1.0));
}

/// (v - v_T) along the line of sight: positive when approaching [m/s].
template <class T>
inline T ClosingSpeed(const Vec3<T>& r_BT_W, const T& distance, const Vec3<T>& v_WB,
                      const Vec3<T>& v_WT) {
  return Dot(v_WB - v_WT, r_BT_W) / Max(distance, T(1e-9));
}

/// d(t-1) - d(t) and closing speed, normalised to [-1, 1]: P and C of Eq. 30.
template <class T>
inline T Progress(const ObservationConfig& c, const T& previous, const T& distance) {
  return Clip((previous - distance) * T(1.0 / c.progress_scale_m), T(-1.0), T(1.0));
}
template <class T>
inline T Closing(const ObservationConfig& c, const T& closing_speed) {
  return Clip(closing_speed * T(1.0 / c.closing_scale_mps), T(-1.0), T(1.0));
}

/// Progress as the observation shows it.
template <class T>
inline T ShownProgress(const ObservationConfig& c, const Knowledge<T>& k) {
  return c.release_bookkeeping ? T(0.0) : Progress(c, k.previous_distance, k.distance);
}

/// One-hot phase (Eq. 15): lost, else stable within the near range, else
/// approach when the distance fell, else search.
template <class T>
inline void PhaseOneHot(const ObservationConfig& c, const T& lost, const T& distance,
                        const T& progress, T (*phase)[4]) {
  const T zero(0.0), one(1.0);
  const auto is_lost = lost > T(0.5);
  const auto near_target = distance <= T(c.near_range_m);
  const auto improving = progress > zero;
  (*phase)[kLost] = Select(is_lost, one, zero);
  (*phase)[kStable] = Select(is_lost, zero, Select(near_target, one, zero));
  const T rest = one - (*phase)[kLost] - (*phase)[kStable];
  (*phase)[kApproach] = Select(improving, rest, zero);
  (*phase)[kSearch] = rest - (*phase)[kApproach];
}

/// One-hot observation quality (Eq. 16) by thresholds on the confidence.
template <class T>
inline void QualityOneHot(const ObservationConfig& c, const T& confidence, T (*quality)[4]) {
  const T zero(0.0), one(1.0);
  const T high = Select(confidence >= T(c.quality_high), one, zero);
  const T medium = Select(confidence >= T(c.quality_medium), one, zero);
  const T low = Select(confidence > zero, one, zero);
  (*quality)[kHigh] = high;
  (*quality)[kMedium] = medium - high;
  (*quality)[kLow] = low - medium;
  (*quality)[kUnavailable] = one - low;
}

/// Graph summary of Eq. 18 as the policy sees it: effective-neighbour fraction,
/// mean and best link quality, mean neighbour error, advantage (Eq. 19), role.
template <class T>
inline void GraphSummary(const ObservationConfig& c, const Knowledge<T>& k, T (*graph)[6]) {
  const T zero(0.0), one(1.0);
  const T scale(1.0 / c.error_scale_m);
  const T neighbour_error = Clip(k.mean_neighbour_error * scale, zero, one);
  (*graph)[0] = k.effective_fraction;
  (*graph)[1] = k.mean_quality;
  (*graph)[2] = k.best_quality;
  (*graph)[3] = neighbour_error;
  (*graph)[4] = neighbour_error - Clip(k.error * scale, zero, one);  // in [-1, 1]
  (*graph)[5] =
      Select((*graph)[4] > zero, Select(k.confidence >= T(c.role_confidence), one, zero), zero);
}

/// z_track of Eq. 14, normalised.
template <class T>
inline void TrackingVector(const ObservationConfig& c, const Knowledge<T>& k, T (*z)[8]) {
  const T zero(0.0), one(1.0), two(2.0);
  (*z)[0] = Clip(k.distance * T(1.0 / c.distance_scale_m), zero, two);
  (*z)[1] = Clip(k.error * T(1.0 / c.error_scale_m), zero, two);
  (*z)[2] = ShownProgress(c, k);
  (*z)[3] = Closing(c, k.closing);
  (*z)[4] = Clip(k.mean_error * T(1.0 / c.error_scale_m), zero, two);
  (*z)[5] = k.confidence;
  (*z)[6] = k.lost;
  (*z)[7] = Clip(k.lost_steps * T(1.0 / c.lost_scale_steps), zero, one);
}

/// Writes the observation through put(index, value), index 0 ..
/// scenario.observation_size() - 1, in the order of release_facts (74 numbers
/// with all blocks on).
template <class T, class Put>
inline void BuildObservation(const AgentConfig& scenario, const Knowledge<T>& k, Put&& put) {
  const ObservationConfig& c = scenario.observation;
  const auto& vm = scenario.vehicle.max_velocity_mps;
  const auto& wm = scenario.vehicle.max_rate_radps;
  const Vec3<double> inv_v{1.0 / vm[0], 1.0 / vm[1], 1.0 / vm[2]};
  const Vec3<double> inv_w{1.0 / wm[0], 1.0 / wm[1], 1.0 / wm[2]};
  const T one(1.0), inv_extent(1.0 / scenario.workspace.half_extent_m);
  int n = 0;
  const auto put3 = [&](const Vec3<T>& v) {
    put(n, v.x);
    put(n + 1, v.y);
    put(n + 2, v.z);
    n += 3;
  };
  const Vec3<T> u = k.v_WT - k.v_WB;  // Eq. 11
  const Vec3<T> p = k.p_WB * inv_extent;
  put3(Clip(p, -2.0, 2.0));
  put3({k.trig.sin_phi, k.trig.cos_phi, k.trig.sin_theta});
  put3({k.trig.cos_theta, k.trig.sin_psi, k.trig.cos_psi});
  put3(Scale(k.v_WB_B, inv_v));
  put3(Scale(k.w_WB_B, inv_w));
  put3(Clip(k.r_BT_W * inv_extent, -2.0, 2.0));
  for (const auto& r : k.neighbour) put3(Clip(r * inv_extent, -2.0, 2.0));
  put3(Clip(Vec3<T>{one - Abs(p.x), one - Abs(p.y), one - Abs(p.z)}, -1.0, 1.0));
  put3(Scale(k.v_WT, inv_v));
  put3(Clip(Scale(u, inv_v), -2.0, 2.0));
  put3(Clip(k.R_WB.TransposeTimes(k.r_BT_W) * inv_extent, -2.0, 2.0));
  put3(Clip(Scale(k.R_WB.TransposeTimes(u), inv_v), -2.0, 2.0));
  put3(k.R_WB.TransposeTimes(k.r_BT_W) * (one / Max(k.distance, T(1e-9))));
  put3({k.tau[0], k.tau[1], k.tau[2]});
  put3({k.tau[3], k.tau[4], k.tau[5]});
  if (c.tracking) {
    T z[8];
    TrackingVector(c, k, &z);
    for (const T& value : z) put(n++, value);
  }
  if (c.semantic) {
    T phase[4], quality[4];
    PhaseOneHot(c, k.lost, k.distance, ShownProgress(c, k), &phase);
    QualityOneHot(c, k.confidence, &quality);
    for (const T& value : phase) put(n++, value);
    for (const T& value : quality) put(n++, value);
    put(n++, k.closest);
  }
  if (c.graph) {
    T graph[6];
    GraphSummary(c, k, &graph);
    for (const T& value : graph) put(n++, value);
  }
}

}  // namespace stg::agent

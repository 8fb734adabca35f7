#pragma once

#include "stg_agent/graph/observation.hpp"
#include "stg_env/task/judge_config.hpp"
#include "stg_env/task/swarm_state.hpp"

/// The critic's state: the true state of the whole swarm as a row of numbers (docs/environment.md).
namespace stg::task {

/// Numbers of one AUV: offset, offset at the scale of the band, relative velocity, rates, force,
/// then distance error, progress, lost and uprightness.
inline constexpr int kVehicleNumbers = 5 * 3 + 4;
/// Further numbers of one AUV in open water, about its own estimate, which decides whether its
/// target is lost: existence, error at the scale of the band, standard deviations in the plane and
/// of depth, and age.
inline constexpr int kEstimateNumbers = 1 + 3 + 3;
/// Numbers of one target: position, velocity.
inline constexpr int kTargetStateNumbers = 2 * 3;

inline int CriticStateSize(const RunConfig& run, const dynamics::WorldConfig& world) {
  const int of_vehicle = kVehicleNumbers + (world.sea.open ? kEstimateNumbers : 0);
  return of_vehicle * run.agents + kTargetStateNumbers * world.target.count;
}

/// Writes the numbers of an AUV's estimate. @param scale 1 / near_scale_m
template <class T>
int WriteEstimate(const FieldState<T>& f, const Vec3<T>& r_BT_W, const T& scale, T* numbers) {
  const T one(1.0), age(1.0 / 60.0);
  const auto share = [&](const T& x) { return x / (one + x); };
  const T level = Sqrt(Max(f.covariance[0] + f.covariance[3], T(0.0)));
  const Vec3<T> error = Clip((f.r_BT_W - r_BT_W) * scale, -1.0, 1.0);
  const T values[kEstimateNumbers] = {one,
                                      error.x,
                                      error.y,
                                      error.z,
                                      share(level * scale),
                                      share(Sqrt(Max(f.covariance[5], T(0.0))) * scale),
                                      share(f.age_s * age)};
  const auto known = f.known > T(0.5);
  for (int k = 0; k < kEstimateNumbers; ++k) numbers[k] = Select(known, values[k], T(0.0));
  return kEstimateNumbers;
}

/// Calls emit(numbers, count) for the blocks of the state in order.
/// @param tracking [agents]
template <class T, class Emit>
void WriteCriticState(const JudgeConfig& s, const SwarmState<T>& swarm,
                      const std::vector<Tracking<T>>& tracking, Emit&& emit) {
  // The band is small in the workspace, so the critic's state has the same offset at both scales.
  const T far(1.0 / s.critic.far_scale_m), near(1.0 / s.critic.near_scale_m);
  const auto& vm = s.world.vehicle.max_velocity_mps;
  const auto& wm = s.world.vehicle.max_rate_radps;
  const Vec3<double> inv_v{1.0 / vm[0], 1.0 / vm[1], 1.0 / vm[2]};
  const Vec3<double> inv_w{1.0 / wm[0], 1.0 / wm[1], 1.0 / wm[2]};
  T block[kVehicleNumbers + kEstimateNumbers];
  int n = 0;
  const auto put3 = [&](const Vec3<T>& v) {
    block[n] = v.x;
    block[n + 1] = v.y;
    block[n + 2] = v.z;
    n += 3;
  };
  for (std::size_t i = 0; i < tracking.size(); ++i) {
    const Tracking<T>& k = tracking[i];
    const dynamics::VehicleState<T>& v = swarm.vehicles[i];
    const Effort<T>& tau = swarm.tau[i];
    n = 0;
    put3(k.r_BT_W * far);
    put3(Clip(k.r_BT_W * near, -1.0, 1.0));
    put3(Scale(swarm.target_of(i).v_WT - v.v_WB, inv_v));
    put3(Scale(v.w_WB_B, inv_w));
    put3({tau[0], tau[1], tau[2]});
    block[n++] = Clip((k.distance - T(s.agent.task.desired_distance_m)) * near, T(-1.0), T(1.0));
    block[n++] = agent::Progress(s.agent.observation, k.previous_distance, k.distance);
    block[n++] = k.lost;
    block[n++] = v.trig.cos_phi * v.trig.cos_theta;
    if (s.world.sea.open) {
      n += WriteEstimate(swarm.field != nullptr ? (*swarm.field)[i] : FieldState<T>{}, k.r_BT_W,
                         near, block + n);
    }
    emit(static_cast<const T*>(block), n);
  }
  for (const dynamics::TargetState<T>& t : swarm.targets) {
    n = 0;
    put3(t.p_WT * far);
    put3(Scale(t.v_WT, inv_v) * T(s.critic.target_speed_gain));
    emit(static_cast<const T*>(block), n);
  }
}

}  // namespace stg::task

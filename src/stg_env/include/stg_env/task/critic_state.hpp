#pragma once

#include "stg_agent/graph/observation.hpp"
#include "stg_env/task/judge_config.hpp"
#include "stg_env/task/swarm_state.hpp"

/// The critic's state: the truth of the whole swarm as a row of numbers (docs/environment.md).
namespace stg::task {

/// Numbers of one AUV: offset, offset at the scale of the band, relative velocity, rates, force,
/// then distance error, progress, lost and uprightness.
inline constexpr int kVehicleNumbers = 5 * 3 + 4;
/// Numbers of one target: position, velocity.
inline constexpr int kTargetNumbers = 2 * 3;

inline int CriticStateSize(int agents, int targets) {
  return kVehicleNumbers * agents + kTargetNumbers * targets;
}

/// Calls emit(numbers, count) for the blocks of the state in order.
/// @param tracking [agents]
template <class T, class Emit>
void WriteCriticState(const JudgeConfig& s, const SwarmState<T>& swarm,
                      const std::vector<Tracking<T>>& tracking, Emit&& emit) {
  // The band is two hundredths of the workspace wide: give the critic the same offset at both
  // scales.
  constexpr double kBandScale_m = 0.05, kTargetSpeedGain = 20.0;
  const auto& vm = s.world.vehicle.max_velocity_mps;
  const auto& wm = s.world.vehicle.max_rate_radps;
  const Vec3<double> inv_v{1.0 / vm[0], 1.0 / vm[1], 1.0 / vm[2]};
  const Vec3<double> inv_w{1.0 / wm[0], 1.0 / wm[1], 1.0 / wm[2]};
  T block[kVehicleNumbers];
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
    const auto target = static_cast<std::size_t>(s.world.target.of(static_cast<int>(i)));
    const Effort<T>& tau = swarm.tau[i];
    n = 0;
    put3(k.r_BT_W);
    put3(Clip(k.r_BT_W * T(1.0 / kBandScale_m), -1.0, 1.0));
    put3(Scale(swarm.targets[target].v_WT - v.v_WB, inv_v));
    put3(Scale(v.w_WB_B, inv_w));
    put3({tau[0], tau[1], tau[2]});
    block[n++] = Clip((k.distance - T(s.agent.task.desired_distance_m)) * T(1.0 / kBandScale_m),
                      T(-1.0), T(1.0));
    block[n++] = agent::Progress(s.agent.observation, k.previous_distance, k.distance);
    block[n++] = k.lost;
    block[n++] = v.trig.cos_phi * v.trig.cos_theta;
    emit(static_cast<const T*>(block), n);
  }
  for (const dynamics::TargetState<T>& t : swarm.targets) {
    n = 0;
    put3(t.p_WT);
    put3(Scale(t.v_WT, inv_v) * T(kTargetSpeedGain));
    emit(static_cast<const T*>(block), n);
  }
}

}  // namespace stg::task

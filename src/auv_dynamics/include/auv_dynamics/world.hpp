#pragma once

#include <cstdint>
#include <vector>

#include "auv_dynamics/scenario.hpp"
#include "auv_dynamics/types.hpp"

namespace stg {

/// Truth of one vehicle: body B in world W.
template <class T>
struct VehicleState {
  Vec3<T> p_WB;       ///< position [m]
  Vec3<T> rpy;        ///< roll, pitch, yaw [rad]; master copy of the semi-implicit integrator
  T q_WB[4] = {T(1.0), T(0.0), T(0.0), T(0.0)};  ///< w x y z; master copy of RK4
  Mat3<T> R_WB;       ///< of the attitude above
  Vec3<T> v_WB_B;     ///< velocity over ground, body axes [m/s]
  Vec3<T> w_WB_B;     ///< body rates p q r [rad/s]
  Vec3<T> v_WB;       ///< velocity over ground, world axes [m/s]
};

template <class T>
struct TargetState {
  Vec3<T> p_WT;       ///< position [m]
  Vec3<T> v_WT;       ///< velocity [m/s]
};

/// kLanes independent copies of one scenario's physics, one per SIMD lane:
/// vehicles (Eqs. 2-3), contacts, walls, targets. Knows nothing of agents,
/// channel or reward. A caller that wants one world uses lane 0.
class World {
 public:
  explicit World(const Scenario& scenario);

  /// Starts an episode in one lane: draws target and vehicles (Table S2, reset
  /// profile `stage`), at rest with zero attitude.
  void Reset(int lane, std::uint64_t seed, std::uint32_t episode, ResetStage stage);

  /// Puts a lane into a given state at the start of an episode (golden traces).
  void Place(int lane, const std::vector<Vec3<double>>& p_WB,
             const std::vector<Vec3<double>>& p_WT, const std::vector<Vec3<double>>& v_WT);

  /// One physics step of dt under tau[i] of each vehicle (body axes). Adds
  /// contact forces, clips to the actuator limits, integrates, applies walls,
  /// moves targets. Lanes with a non-finite wrench are a bug (assert); nodes
  /// check their messages before.
  void Step(const std::vector<Wrench<Pack>>& tau);

  int agents() const { return static_cast<int>(vehicles_.size()); }
  int targets() const { return static_cast<int>(targets_.size()); }
  const VehicleState<Pack>& vehicle(int i) const { return vehicles_[static_cast<size_t>(i)]; }
  const TargetState<Pack>& target(int k) const { return targets_[static_cast<size_t>(k)]; }
  /// Wrench that acted in the last step, after contacts and limits.
  const Wrench<Pack>& applied(int i) const { return applied_[static_cast<size_t>(i)]; }
  /// Wrench that was commanded in the last step, after limits, before contacts.
  const Wrench<Pack>& commanded(int i) const { return commanded_[static_cast<size_t>(i)]; }

  /// Truth of one lane as the vehicle's own navigation gives it.
  NavState Nav(int lane, int i) const;
  /// Simulated time since the start of the episode, one physics step per Step.
  TimeNs time(int lane) const;
  std::uint32_t step(int lane) const { return step_[lane]; }
  std::uint32_t episode(int lane) const { return episode_[lane]; }

  /// Detection of target k by vehicle i at the current step; false when out of
  /// range, missed or blind. Draws depend on (seed, episode, step, i, k) only.
  bool Sense(int lane, int i, int k, Detection* out) const;
  /// Datum that vehicle i starts the episode with.
  Cue InitialCue(int lane, int i, int k) const;

  /// Pairs of vehicles closer than two radii, and the smallest distance [m], in the
  /// current state.
  Pack colliding_pairs() const;
  Pack smallest_separation() const;

 private:
  const Scenario scenario_;
  std::vector<VehicleState<Pack>> vehicles_;
  std::vector<TargetState<Pack>> targets_;
  std::vector<Wrench<Pack>> applied_, commanded_;
  std::uint64_t seed_[kLanes] = {};
  std::uint32_t episode_[kLanes] = {};
  std::uint32_t step_[kLanes] = {};
};

}  // namespace stg

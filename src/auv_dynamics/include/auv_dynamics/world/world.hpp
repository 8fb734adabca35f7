#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace stg::dynamics {

/// Truth of one vehicle: body B in world W.
template <class T>
struct VehicleState {
  Vec3<T> p_WB;  ///< position [m]
  Vec3<T> rpy;   ///< roll, pitch, yaw [rad]; master copy of the semi-implicit integrator
  T q_WB[4] = {T(1.0), T(0.0), T(0.0), T(0.0)};  ///< w x y z; master copy of RK4
  Mat3<T> R_WB;                                  ///< of the attitude above
  EulerTrig<T> trig;                             ///< of the attitude above
  Vec3<T> v_WB_B;                                ///< velocity over ground, body axes [m/s]
  Vec3<T> w_WB_B;                                ///< body rates p q r [rad/s]
  Vec3<T> v_WB;                                  ///< velocity over ground, world axes [m/s]
};

/// A target, world axes.
template <class T>
struct TargetState {
  Vec3<T> p_WT;  ///< position [m]
  Vec3<T> v_WT;  ///< velocity [m/s]
};

class VehicleModel;

/// kLanes independent copies of one scenario's physics, one per SIMD lane:
/// vehicles (Eqs. 2-3), contacts, walls, targets. Knows nothing of agents,
/// channel or reward. A caller that wants one world uses lane 0.
class World {
 public:
  /// Throws UserError for a scenario that fails its validation.
  explicit World(const WorldConfig& scenario);
  ~World();
  World(World&&) noexcept;

  /// Starts an episode in one lane: draws target and vehicles (Table S2, reset
  /// profile `stage`), at rest with zero attitude.
  void Reset(int lane, std::uint64_t seed, std::uint32_t episode, ResetStage stage);

  /// Starts an episode in one lane from given world positions and target
  /// velocities, vehicles at rest with zero attitude (golden traces, tests).
  void Place(int lane, const std::vector<Vec3<double>>& p_WB, const std::vector<Vec3<double>>& p_WT,
             const std::vector<Vec3<double>>& v_WT);

  /// Takes the present state of a swarm that moves elsewhere, in every lane; clocks stand still.
  void Follow(const std::vector<NavState>& vehicles,
              const std::vector<TargetState<double>>& targets);

  /// One physics step of dt under the commanded wrench of each vehicle (body
  /// axes). Adds contact forces, clips to the actuator limits, integrates,
  /// applies walls, moves targets. A non-finite wrench is a bug of the caller.
  void Step(const std::vector<Wrench<Pack>>& tau);

  int agents() const { return static_cast<int>(vehicles_.size()); }
  int targets() const { return static_cast<int>(targets_.size()); }
  const VehicleModel& model() const { return *model_; }
  const VehicleState<Pack>& vehicle(int i) const { return vehicles_[static_cast<size_t>(i)]; }
  VehicleState<Pack>& mutable_vehicle(int i) { return vehicles_[static_cast<size_t>(i)]; }
  const TargetState<Pack>& target(int k) const { return targets_[static_cast<size_t>(k)]; }
  /// Distance between vehicles i and j in the current state [m].
  const Pack& distance(int i, int j) const {
    return distances_[static_cast<size_t>(i * agents() + j)];
  }

  /// Truth of one lane as the vehicle's own navigation gives it.
  NavState Nav(int lane, int i) const;
  /// The same of all lanes.
  Navigation<Pack> Nav(int i) const;
  /// Simulated time since the start of the episode: physics steps times dt.
  TimeNs time(int lane) const { return dt_ns_ * static_cast<TimeNs>(step_[lane]); }
  std::uint32_t step(int lane) const { return step_[lane]; }
  std::uint32_t episode(int lane) const { return episode_[lane]; }
  std::uint64_t seed(int lane) const { return seed_[lane]; }

  /// Detection of target k by vehicle i at the current step; false when out of
  /// range, missed or blind. Draws depend on (seed, episode, step, i, k) only.
  bool Sense(int lane, int i, int k, Detection* out) const;
  /// Datum that vehicle i starts the episode with.
  Cue InitialCue(int lane, int i, int k) const;

  /// Pairs of vehicles closer than two radii, and the smallest distance between
  /// any two vehicles [m], in the current state.
  const Pack& colliding_pairs() const { return colliding_pairs_; }
  const Pack& smallest_separation() const { return smallest_separation_; }

 private:
  void StartLane(int lane, std::uint64_t seed, std::uint32_t episode);
  void AddContacts();
  void AddDisturbance();
  void ApplyWalls(VehicleState<Pack>* vehicle) const;
  void MoveTargets();
  void SteerTarget(int lane, int k);
  void MeasureDistances();

  WorldConfig scenario_;
  TimeNs dt_ns_;
  std::unique_ptr<VehicleModel> model_;
  std::vector<VehicleState<Pack>> vehicles_;
  std::vector<TargetState<Pack>> targets_;
  std::vector<Vec3<Pack>> contact_;        // world-frame contact force of each vehicle [N]
  std::vector<Wrench<Pack>> disturbance_;  // w of Eq. 3, body axes
  std::vector<Pack> distances_;            // [agents, agents], symmetric
  std::vector<std::uint32_t> waypoint_;    // [lane, target]
  Pack colliding_pairs_ = Pack(0.0), smallest_separation_ = Pack(0.0);
  std::uint64_t seed_[kLanes] = {};
  std::uint32_t episode_[kLanes] = {};
  std::uint32_t step_[kLanes] = {};
};

}  // namespace stg::dynamics

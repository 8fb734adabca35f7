#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "auv_common/numbers/short_list.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/navigation/navigation_system.hpp"
#include "auv_dynamics/sensing/target_sensor.hpp"
#include "auv_dynamics/targets/target_motion.hpp"
#include "auv_dynamics/vehicle/vehicle_set.hpp"
#include "auv_dynamics/world/contacts.hpp"
#include "auv_dynamics/world/current.hpp"
#include "auv_dynamics/world/disturbance.hpp"
#include "auv_dynamics/world/sea.hpp"
#include "auv_dynamics/world/separations.hpp"
#include "auv_dynamics/world/starts.hpp"
#include "auv_dynamics/world/walls.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace stg::dynamics {

/// Advice for a state that is not finite.
inline constexpr char kUnstableHint[] =
    "the motion is unstable with these vehicle constants; check damping, mass and limits, clip "
    "velocities (vehicle.clip_velocity), or use a smaller time.dt_s or more vehicle.substeps";

/// kLanes independent copies of one scenario's physics, one per SIMD lane: vehicles, contacts,
/// walls, targets, sensors. The registries make its vehicles, target motion and sensor. It is
/// independent of agents, channel and reward. A caller that needs one world uses lane 0.
class World {
 public:
  /// Throws UserError for a scenario that fails its validation.
  /// @param stated errors that the vehicles' navigation states, which may differ from its true ones
  World(const WorldConfig& config, const RunConfig& run, const NavigationConfig& stated);
  World(const WorldConfig& config, const RunConfig& run) : World(config, run, config.navigation) {}
  explicit World(const WorldScenario& s) : World(s.world, s.run, s.believed().navigation) {}
  ~World();
  World(World&&) noexcept;

  /// Starts an episode in one lane: draws target and vehicles (Table S2, reset
  /// profile `stage`), at rest with zero attitude.
  void Reset(int lane, std::uint64_t seed, std::uint32_t episode, ResetStage stage);

  /// Starts an episode in one lane from given world positions and target
  /// velocities, vehicles at rest with zero attitude (golden traces, tests). Throws UserError for a
  /// place inside the bottom or an obstacle of open water, or above its surface.
  void Place(int lane, const std::vector<Vec3<double>>& p_WB, const std::vector<Vec3<double>>& p_WT,
             const std::vector<Vec3<double>>& v_WT);

  /// One physics step of dt: steps each vehicle under its command, contacts, current and
  /// disturbance, applies walls, moves targets. A non-finite command is a bug of the caller.
  ///
  /// @param commands [agents, command_size()], row-major; a vehicle takes as many numbers of its
  /// row as it has actuators
  void Step(const std::vector<Pack>& commands);
  /// The same for vehicles that take a generalised force, one for each. Throws UserError for other
  /// vehicles.
  void Step(const std::vector<Wrench<Pack>>& tau);

  /// Throws UserError that names vehicle, step and seed when the state of a vehicle is not finite:
  /// the integration is then unstable.
  void CheckFinite() const;

  int agents() const { return static_cast<int>(vehicles_.size()); }
  int targets() const { return static_cast<int>(targets_.size()); }
  /// The model of vehicle i.
  const Vehicle& model(int i = 0) const { return kinds_[i]; }
  std::size_t command_size() const { return kinds_.command_size(); }
  const TargetSensor& sensor() const { return *sensor_; }
  const VehicleState<Pack>& vehicle(int i) const { return vehicles_[static_cast<size_t>(i)]; }
  VehicleState<Pack>& mutable_vehicle(int i) { return vehicles_[static_cast<size_t>(i)]; }
  const TargetState<Pack>& target(int k) const { return targets_[static_cast<size_t>(k)]; }
  /// Distance between vehicles i and j in the current state [m].
  const Pack& distance(int i, int j) const { return separations_.distance(i, j); }
  const Separations<Pack>& separations() const { return separations_; }
  const std::vector<VehicleState<Pack>>& vehicle_states() const { return vehicles_; }
  const std::vector<TargetState<Pack>>& target_states() const { return targets_; }

  /// The navigated state of vehicle i; the true one where `navigation.kind` is perfect.
  NavState Nav(int lane, int i) const;
  /// The same of all lanes.
  Navigation<Pack> Nav(int i) const;
  /// The true state of vehicle i, for any navigation.
  NavState Truth(int lane, int i) const;
  /// Simulated time since the start of the episode: physics steps times dt.
  TimeNs time(int lane) const { return dt_ns_ * static_cast<TimeNs>(step(lane)); }
  std::uint32_t step(int lane) const { return clock(lane).step; }
  std::uint32_t episode(int lane) const { return clock(lane).episode; }
  std::uint64_t seed(int lane) const { return clock(lane).seed; }

  /// Detection of target k by vehicle i at the current step; false when there is none, for example
  /// because bottom or obstacles are between them. Draws depend on (seed, episode, step, i, k)
  /// only.
  bool Sense(int lane, int i, int k, Detection* out) const;
  /// Calls take(const Detection&) for each detection of vehicle i at the current step: by target.
  /// If detections are not labelled (sensing.labelled), neither a detection nor their order says
  /// which target it is of.
  template <class Take>
  void SenseTargets(int lane, int i, const Take& take) const {
    if (!sensing_.labelled) {
      UnlabelledLook look;
      SenseUnlabelled(lane, i, &look);
      for (const Detection& detection : look) take(detection);
      return;
    }
    for (int k = 0; k < targets(); ++k) {
      Detection detection;
      if (Sense(lane, i, k, &detection)) take(detection);
    }
  }
  /// Datum of vehicle i at the start of the episode.
  Cue InitialCue(int lane, int i, int k) const;

  /// Pairs of vehicles closer than two radii, and the smallest distance between
  /// any two vehicles [m], in the current state.
  const Pack& colliding_pairs() const { return separations_.colliding_pairs(); }
  const Pack& smallest_separation() const { return separations_.smallest(); }

  /// Surface, bottom and obstacles, in scenarios in open water.
  const Sea& sea() const { return sea_; }
  bool open_water() const { return open_; }

 private:
  using UnlabelledLook = ShortList<Detection, kMostTargets>;
  void SenseUnlabelled(int lane, int i, UnlabelledLook* look) const;
  const EpisodeClock& clock(int lane) const { return clocks_[static_cast<size_t>(lane)]; }
  Pack Time() const;
  /// @param name with its number, for the message
  void RequireWater(const std::string& name, const Vec3<double>& p_W) const;
  Navigation<Pack> TrueNav(int i) const;
  void Navigate();
  void StartLane(int lane, std::uint64_t seed, std::uint32_t episode, const Start& start);

  double dt_s_;
  TimeNs dt_ns_;
  Current current_;
  Vec3<Pack> v_WC_;  // for a uniform current
  ResetConfig reset_;
  SeaConfig depths_;
  SensingConfig sensing_;
  VehicleSet kinds_;
  std::unique_ptr<TargetMotion> motion_;
  std::unique_ptr<const TargetSensor> sensor_;
  std::unique_ptr<NavigationSystem> navigation_;
  bool perfect_;  // navigation
  Separations<Pack> separations_;
  Contacts contacts_;
  Disturbance disturbance_;
  Walls walls_;
  Sea sea_;
  bool open_;  // sea, not walls
  std::vector<VehicleState<Pack>> vehicles_;
  std::vector<TargetState<Pack>> targets_;
  std::vector<Pack> internal_;  // [agents, kinds_.internal_size()]
  std::vector<Pack> commands_;  // [agents, actuators], of the last generalised forces
  Start start_;                 // scratch of Reset
  EpisodeClocks clocks_{};
};

}  // namespace stg::dynamics

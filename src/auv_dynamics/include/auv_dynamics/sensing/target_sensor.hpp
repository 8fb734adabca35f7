#pragma once

#include <cstdint>

#include "auv_common/registry.hpp"
#include "auv_dynamics/episode_clock.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/navigation/navigation_system.hpp"
#include "auv_dynamics/sensing/sensing_config.hpp"
#include "auv_dynamics/targets/target_state.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// Input of one measurement of one target by one vehicle, in one lane: the true states, and the
/// source of random draws.
struct Look {
  int lane;
  const EpisodeClock& clock;
  double time_s;  ///< since the start of the episode
  TimeNs stamp;   ///< the same
  int target;
  std::uint32_t pair;  ///< index of this vehicle and target for draws of Stream::kDetection
  const VehicleState<Pack>& vehicle_state;
  const TargetState<Pack>& target_state;
  Observer observer;    ///< navigated state of the vehicle; detections are in its frame
  bool drifts = false;  ///< the navigated state differs from the truth

  Vec3<double> p_WB() const { return Lane(vehicle_state.p_WB, lane); }
  Vec3<double> p_WT() const { return Lane(target_state.p_WT, lane); }
};

/// The agents' own sensor of targets. It has no memory: its result in a step is a function of the
/// look alone, for any number and order of calls.
class TargetSensor {
 public:
  virtual ~TargetSensor() = default;

  /// Kind of measurement in its detections.
  virtual MeasurementKind kind() const = 0;

  /// Fills `out` when the target is detected, else returns false and leaves `out` undefined.
  virtual bool Sense(const Look& look, Detection* out) const = 0;
};

/// The names for `sensing.sensor`. To add a sensor, write a new file and one line in
/// src/sensing/target_sensors.cpp; another program calls Add before it loads a scenario.
using SensorRegistry = Registry<const TargetSensor, const SensingConfig&>;
SensorRegistry& TargetSensors();

/// Removes the target from a detection.
void RemoveLabel(Detection* detection);
/// An order of the detections of one look that depends only on what they measure.
bool MeasuresLess(const Detection& a, const Detection& b);

/// The cue on target k at the start of an episode: its position at the start with the stated
/// uncertainty, the same for every vehicle, like one contact report that starts a search.
Cue DrawCue(const SensingConfig& config, const EpisodeClock& clock, int k,
            const Vec3<double>& p_WT);

}  // namespace stg::dynamics

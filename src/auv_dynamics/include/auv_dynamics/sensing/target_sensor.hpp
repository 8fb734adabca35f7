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

/// One look of one vehicle at one target, in one lane: the truth, and where its draws come from.
struct Look {
  int lane;
  const EpisodeClock& clock;
  double time_s;  ///< since the start of the episode
  TimeNs stamp;   ///< the same
  int target;
  std::uint32_t pair;  ///< index of this vehicle and target for draws of Stream::kDetection
  const VehicleState<Pack>& vehicle_state;
  const TargetState<Pack>& target_state;
  Observer observer;    ///< what the vehicle believes of itself, in whose frame it tells
  bool drifts = false;  ///< which is not the truth

  Vec3<double> p_WB() const { return Lane(vehicle_state.p_WB, lane); }
  Vec3<double> p_WT() const { return Lane(target_state.p_WT, lane); }
};

/// The agents' own sensor of targets. It has no memory: what it sees in a step is a function of the
/// look alone, however often it is asked and in whatever order.
class TargetSensor {
 public:
  virtual ~TargetSensor() = default;

  /// What its detections hold.
  virtual MeasurementKind kind() const = 0;

  /// Fills `out` when the target is detected, else returns false and leaves `out` undefined.
  virtual bool Sense(const Look& look, Detection* out) const = 0;
};

/// What `sensing.sensor` may name. A new sensor is a new file and one line in
/// src/sensing/target_sensors.cpp; a sensor of another program is added with Add before it loads a
/// scenario.
using SensorRegistry = Registry<const TargetSensor, const SensingConfig&>;
SensorRegistry& TargetSensors();

/// The datum on target k that an episode starts with: its position at the start with the stated
/// uncertainty, the same for every vehicle, as one contact report starts the search.
Cue DrawCue(const SensingConfig& config, const EpisodeClock& clock, int k,
            const Vec3<double>& p_WT);

}  // namespace stg::dynamics

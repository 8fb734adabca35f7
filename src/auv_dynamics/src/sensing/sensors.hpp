#pragma once

#include <memory>

#include "auv_dynamics/sensing/target_sensor.hpp"

/// The sensors of this package: their rules stand in docs/sensors.md, their code in the file of
/// their name.
namespace stg::dynamics {

std::unique_ptr<const TargetSensor> MakePositionSensor(const SensingConfig& config);
std::unique_ptr<const TargetSensor> MakeRangeSensor(const RelativeOptions& options,
                                                    const SensingConfig& config);
std::unique_ptr<const TargetSensor> MakeBearingSensor(const RelativeOptions& options,
                                                      const SensingConfig& config);
std::unique_ptr<const TargetSensor> MakeRangeBearingSensor(const RelativeOptions& options,
                                                           const SensingConfig& config);

/// Whether a look falls on the sensor's period.
bool LooksNow(const SensingConfig& config, const Look& look);
/// Dropouts start in each spell-long slot with the probability of a Poisson process of the given
/// rate and blind the sensor for that slot: memoryless across slots, so that a draw needs no
/// history.
bool Blind(const SensingConfig& config, const Look& look);
/// Fills what every detection holds besides the measurement: when, of what, by which vehicle.
void SetObserver(const Look& look, Detection* out);

}  // namespace stg::dynamics

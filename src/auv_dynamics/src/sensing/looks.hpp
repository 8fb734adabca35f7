#pragma once

#include "auv_dynamics/sensing/target_sensor.hpp"

/// What sensors have in common: docs/sensors.md has their rules.
namespace stg::dynamics {

/// Whether a look falls on the sensor's period.
bool LooksNow(const SensingConfig& config, const Look& look);
/// Dropouts start in each spell-long slot with the probability of a Poisson process of the given
/// rate and blind the sensor for that slot: memoryless across slots, so that a draw needs no
/// history.
bool Blind(const SensingConfig& config, const Look& look);
/// Fills what every detection holds besides the measurement: when, of what, by which vehicle.
void SetObserver(const Look& look, Detection* out);

}  // namespace stg::dynamics

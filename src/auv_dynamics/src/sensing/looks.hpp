#pragma once

#include "auv_dynamics/sensing/target_sensor.hpp"

/// Common parts of the sensors. docs/sensors.md has their rules.
namespace stg::dynamics {

/// True if a look is at the sensor's period.
bool LooksNow(const SensingConfig& config, const Look& look);
/// True if the sensor has a dropout. Dropouts start in each slot of the length of a spell, with the
/// probability of a Poisson process of the given rate, and last for this slot. The slots are
/// independent, so a draw needs no history.
bool Blind(const SensingConfig& config, const Look& look);
/// Writes everything in a detection except the measurement: time, target and vehicle.
void SetObserver(const Look& look, Detection* out);

}  // namespace stg::dynamics

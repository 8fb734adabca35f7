#pragma once

#include <memory>

#include "auv_dynamics/sensing/target_sensor.hpp"

/// The sensors of this package: their rules stand in docs/dynamics.md, their code in the file of
/// their name.
namespace stg::dynamics {

std::unique_ptr<const TargetSensor> MakePositionSensor(const SensingConfig& config);

}  // namespace stg::dynamics

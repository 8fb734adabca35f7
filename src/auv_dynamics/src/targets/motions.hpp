#pragma once

#include <memory>

#include "auv_dynamics/targets/target_motion.hpp"

/// The motions of this package: their rules stand in docs/dynamics.md, their code in the file of
/// their name.
namespace stg::dynamics {

std::unique_ptr<TargetMotion> MakeConstantVelocity(const MotionSetup& setup);
std::unique_ptr<TargetMotion> MakeCoordinatedTurn(const MotionSetup& setup);
std::unique_ptr<TargetMotion> MakeRandomWaypoint(const MotionSetup& setup);
std::unique_ptr<TargetMotion> MakeEvasive(const MotionSetup& setup);

}  // namespace stg::dynamics

#pragma once

#include <memory>

#include "auv_dynamics/targets/target_motion.hpp"

/// The motions of this package: their rules stand in docs/dynamics.md, their code in the file of
/// their name.
namespace stg::dynamics {

struct CoordinatedTurnOptions {
  double rate_radps = 0.1, period_s = 10.0;
};
void Describe(CoordinatedTurnOptions* o, config::Table* t);
struct RandomWaypointOptions {
  double radius_m = 0.05;
};
void Describe(RandomWaypointOptions* o, config::Table* t);
struct EvasiveOptions {
  double range_m = 0.10;
};
void Describe(EvasiveOptions* o, config::Table* t);

std::unique_ptr<TargetMotion> MakeConstantVelocity(const MotionSetup& setup);
std::unique_ptr<TargetMotion> MakeCoordinatedTurn(const CoordinatedTurnOptions& options,
                                                  const MotionSetup& setup);
std::unique_ptr<TargetMotion> MakeRandomWaypoint(const RandomWaypointOptions& options,
                                                 const MotionSetup& setup);
std::unique_ptr<TargetMotion> MakeEvasive(const EvasiveOptions& options, const MotionSetup& setup);

}  // namespace stg::dynamics

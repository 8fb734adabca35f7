#include "auv_dynamics/targets/target_motion.hpp"

namespace stg::dynamics {

MotionRegistry& TargetMotions() {
  static MotionRegistry registry("target motion",
                                 {
                                     STG_ENTRY(MotionRegistry, ConstantVelocityEntry),
                                     STG_ENTRY(MotionRegistry, CoordinatedTurnEntry),
                                     STG_ENTRY(MotionRegistry, LegsEntry),
                                     STG_ENTRY(MotionRegistry, RandomWaypointEntry),
                                     STG_ENTRY(MotionRegistry, EvasiveEntry),
                                 });
  return registry;
}

}  // namespace stg::dynamics

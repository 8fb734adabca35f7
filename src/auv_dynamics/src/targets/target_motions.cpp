#include "auv_dynamics/targets/target_motion.hpp"
#include "motions.hpp"

namespace stg::dynamics {

MotionRegistry& TargetMotions() {
  static MotionRegistry registry("target motion", {
                                                      {"constant_velocity", MakeConstantVelocity},
                                                      {"coordinated_turn", MakeCoordinatedTurn},
                                                      {"random_waypoint", MakeRandomWaypoint},
                                                      {"evasive", MakeEvasive},
                                                  });
  return registry;
}

}  // namespace stg::dynamics

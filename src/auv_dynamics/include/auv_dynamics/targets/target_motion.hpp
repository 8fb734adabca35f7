#pragma once

#include <vector>

#include "auv_common/registry.hpp"
#include "auv_dynamics/episode_clock.hpp"
#include "auv_dynamics/targets/target_config.hpp"
#include "auv_dynamics/targets/target_state.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// Data from which a motion is made. The motion copies the parts that it needs later.
struct MotionSetup {
  const TargetConfig& target;
  double half_extent_m;  ///< walls at +- this value on each axis; infinity: there are none
  double dt_s;           ///< physics step
  double region_m;       ///< half the size of the region of waypoints
};

/// Motion of the targets of one World. One object moves all of them, in every lane, and holds its
/// own memory. All random numbers must be the clock's draws with Stream::kTarget and the target's
/// index; otherwise lanes and programs would differ.
class TargetMotion {
 public:
  virtual ~TargetMotion() = default;

  /// An episode starts in this lane.
  virtual void Reset(int lane) { (void)lane; }

  /// Moves all targets by one physics step, in every lane, and leaves them inside the walls.
  ///
  /// @param clocks   of the step that begins
  /// @param vehicles their states after their own step
  /// @param targets  in and out
  virtual void Step(const EpisodeClocks& clocks, const std::vector<VehicleState<Pack>>& vehicles,
                    std::vector<TargetState<Pack>>* targets) = 0;
};

/// The names for `target.motion`. To add a motion, write a new file and one line in
/// src/targets/target_motions.cpp; another program calls Add before it loads a scenario.
using MotionRegistry = Registry<TargetMotion, const MotionSetup&>;
MotionRegistry& TargetMotions();

}  // namespace stg::dynamics

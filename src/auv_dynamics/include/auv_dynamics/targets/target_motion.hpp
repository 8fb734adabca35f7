#pragma once

#include <vector>

#include "auv_common/registry.hpp"
#include "auv_dynamics/episode_clock.hpp"
#include "auv_dynamics/targets/target_config.hpp"
#include "auv_dynamics/targets/target_state.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// What a motion is made from. It copies what it keeps.
struct MotionSetup {
  const TargetConfig& target;
  double half_extent_m;  ///< walls at +- this value on each axis; infinity: there are none
  double dt_s;           ///< physics step
  double region_m;       ///< half the size of the region that waypoints are drawn from
};

/// How the targets of one World move. One object moves all of them, in every lane; what it
/// remembers of them is its own. Random numbers come from the clock's draws with Stream::kTarget
/// and the target's index, and from nothing else, or lanes and programs would differ.
class TargetMotion {
 public:
  virtual ~TargetMotion() = default;

  /// An episode starts in this lane.
  virtual void Reset(int lane) { (void)lane; }

  /// Moves all targets by one physics step, in every lane, and leaves them inside the walls.
  ///
  /// @param clocks   of the step that begins
  /// @param vehicles as they are after their own step
  /// @param targets  in and out
  virtual void Step(const EpisodeClocks& clocks, const std::vector<VehicleState<Pack>>& vehicles,
                    std::vector<TargetState<Pack>>* targets) = 0;
};

/// What `target.motion` may name. A new motion is a new file and one line in
/// src/targets/target_motions.cpp; a motion of another program is added with Add before it loads a
/// scenario.
using MotionRegistry = Registry<TargetMotion, const MotionSetup&>;
MotionRegistry& TargetMotions();

}  // namespace stg::dynamics

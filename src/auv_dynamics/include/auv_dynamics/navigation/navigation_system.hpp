#pragma once

#include <vector>

#include "auv_common/registry.hpp"
#include "auv_dynamics/episode_clock.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/navigation/navigation_config.hpp"
#include "auv_dynamics/terrain/terrain.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// What a navigation system is made from. It copies what it keeps.
struct NavigationSetup {
  const NavigationConfig& navigation;
  int vehicles;
  double dt_s;                     ///< physics step
  const NavigationConfig& stated;  ///< what it takes its errors for, when it states them
};

/// Where a vehicle takes itself to be while it looks at a target, in one lane.
struct Observer {
  Vec3<double> p_WO;               ///< its position as it believes [m]
  double position_std_m = 0.0;     ///< as stated, of each horizontal component
  double heading_error_rad = 0.0;  ///< by which all that it says of directions is turned, truly
  double heading_std_rad = 0.0;    ///< as stated
};

/// What the vehicles of one World know of their own motion, in every lane. Random numbers come from
/// the clock's draws with Stream::kNavigation and Stream::kNavigationStart alone.
class NavigationSystem {
 public:
  virtual ~NavigationSystem() = default;

  /// It tells the truth, and nothing below is called.
  virtual bool perfect() const { return false; }

  /// An episode starts in this lane with vehicle i in this state.
  virtual void Reset(int lane, int i, const EpisodeClock& clock,
                     const VehicleState<Pack>& vehicle) = 0;
  /// After each physics step: clocks and state are those of its end.
  /// @param v_WC current at the vehicle, world axes [m/s]
  virtual void Step(int i, const EpisodeClocks& clocks, const VehicleState<Pack>& vehicle,
                    const Vec3<Pack>& v_WC, const Terrain& terrain) = 0;
  /// Turns the truth about vehicle i into what it believes.
  virtual void Believe(int i, Navigation<Pack>* navigation) const = 0;
  /// The same for its position and heading in one lane.
  virtual Observer At(int lane, int i) const = 0;
};

/// What `navigation.kind` may name. A new kind is a new file and one line in
/// src/navigation/navigation_systems.cpp; a kind of another program is added with Add before it
/// loads a scenario.
using NavigationRegistry = Registry<NavigationSystem, const NavigationSetup&>;
NavigationRegistry& NavigationSystems();

}  // namespace stg::dynamics

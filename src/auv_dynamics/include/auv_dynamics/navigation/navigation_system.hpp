#pragma once

#include <vector>

#include "auv_common/registry.hpp"
#include "auv_dynamics/episode_clock.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/navigation/navigation_config.hpp"
#include "auv_dynamics/terrain/terrain.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// Data from which a navigation system is made. The system copies the parts that it needs later.
struct NavigationSetup {
  const NavigationConfig& navigation;
  int vehicles;
  double dt_s;                     ///< physics step
  const NavigationConfig& stated;  ///< errors of which it states the deviations
};

/// Navigated position and heading of a vehicle that looks at a target, in one lane.
struct Observer {
  Vec3<double> p_WO;               ///< navigated position [m]
  double position_std_m = 0.0;     ///< stated, of each horizontal component
  double heading_error_rad = 0.0;  ///< true error of all its directions
  double heading_std_rad = 0.0;    ///< stated
};

/// Navigation of the vehicles of one World, in every lane. All random numbers must be the clock's
/// draws with Stream::kNavigation and Stream::kNavigationStart.
class NavigationSystem {
 public:
  virtual ~NavigationSystem() = default;

  /// True: it gives the true state, and no other function is called.
  virtual bool perfect() const { return false; }

  /// An episode starts in this lane with vehicle i in this state.
  virtual void Reset(int lane, int i, const EpisodeClock& clock,
                     const VehicleState<Pack>& vehicle) = 0;
  /// Called after each physics step, with clocks and state at its end.
  /// @param v_WC current at the vehicle, world axes [m/s]
  virtual void Step(int i, const EpisodeClocks& clocks, const VehicleState<Pack>& vehicle,
                    const Vec3<Pack>& v_WC, const Terrain& terrain) = 0;
  /// Changes the true state of vehicle i into its navigated state.
  virtual void Believe(int i, Navigation<Pack>* navigation) const = 0;
  /// The same for its position and heading in one lane.
  virtual Observer At(int lane, int i) const = 0;
};

/// The names for `navigation.kind`. To add a kind, write a new file and one line in
/// src/navigation/navigation_systems.cpp; another program calls Add before it loads a scenario.
using NavigationRegistry = Registry<NavigationSystem, const NavigationSetup&>;
NavigationRegistry& NavigationSystems();

/// Whether the chosen navigation is `dead_reckoning`, whose options then have an effect.
bool ReckonsPosition(const NavigationConfig& c);

}  // namespace stg::dynamics

#pragma once

#include <limits>
#include <optional>

#include "auv_common/config/run_config.hpp"
#include "auv_dynamics/control/control_config.hpp"
#include "auv_dynamics/navigation/navigation_config.hpp"
#include "auv_dynamics/sensing/sensing_config.hpp"
#include "auv_dynamics/targets/target_config.hpp"
#include "auv_dynamics/terrain/sea_config.hpp"
#include "auv_dynamics/vehicle/vehicle_config.hpp"
#include "auv_dynamics/world/reset_config.hpp"
#include "auv_dynamics/world/surroundings_config.hpp"

namespace stg::dynamics {

/// Vehicles, what surrounds them, what they follow and sense, and how they are steered.
struct WorldConfig : RunConfig {
  VehicleConfig vehicle;
  CurrentConfig current;
  DisturbanceConfig disturbance;
  ContactConfig contact;
  WorkspaceConfig workspace;
  SeaConfig sea;
  TargetConfig target;
  ResetConfig reset;
  NavigationConfig navigation;
  SensingConfig sensing;
  ControlConfig control;

  /// Target that agent i is tasked with: i modulo the number of targets.
  int target_of(int agent) const { return agent % target.count; }
  /// Where the walls are on each axis [m]; infinity: there are none.
  double wall_m() const {
    return sea.open ? std::numeric_limits<double>::infinity() : workspace.half_extent_m;
  }
  int action_size() const { return ActionSize(control.interface); }
};

/// The sections besides those of RunConfig.
void DescribeSections(WorldConfig* c, config::Table* t);
/// All of it.
void Describe(WorldConfig* c, config::Table* t);
/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const WorldConfig& c);

}  // namespace stg::dynamics

#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

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

/// Vehicles, surroundings, targets, sensing and control.
struct WorldConfig {
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
};

/// Distance of the walls on each axis [m]; infinity: there are none.
inline double WallOf(const WorkspaceConfig& workspace, const SeaConfig& sea) {
  return sea.open ? std::numeric_limits<double>::infinity() : workspace.half_extent_m;
}

/// Keys, units and ranges of the sections.
void Describe(WorldConfig* c, config::Table* t);
/// Keys for which vehicles may have another value on board than the true one: keys of the vehicle,
/// its instruments, the water and the targets.
const std::vector<std::string>& KeysOnBoard();
/// The world that vehicles assume if it differs from the true one in these keys.
WorldConfig Believed(WorldConfig world, const config::Differences& agent_model);
/// Contradictions between their keys, and with those of the run.
std::optional<config::Violation> FindConflict(const WorldConfig& c, const RunConfig& run);

/// Sections of a program that moves or steers vehicles.
struct WorldScenario {
  RunConfig run;
  WorldConfig world;
  config::Differences agent_model;  ///< of KeysOnBoard; empty: all values are the true ones

  WorldConfig believed() const { return Believed(world, agent_model); }
};
void Describe(WorldScenario* s, config::Table* t);
std::optional<config::Violation> FindConflict(const WorldScenario& s);

}  // namespace stg::dynamics

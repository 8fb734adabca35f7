#pragma once

#include <cstdint>
#include <vector>

#include "auv_dynamics/targets/target_state.hpp"
#include "auv_dynamics/terrain/seascape.hpp"
#include "auv_dynamics/world/reset_config.hpp"

namespace stg::dynamics {

/// Where an episode starts, world axes.
struct Start {
  std::vector<Vec3<double>> p_WB;  ///< positions of the vehicles [m]
  std::vector<TargetState<double>> targets;
};

/// Draws the start of an episode (Table S2): targets around the origin, each vehicle around its
/// target (vehicle i around target i modulo their number) at a distance from the others. Throws
/// UserError when there is no room.
///
/// @param start in and out: its sizes are the numbers of vehicles and targets
void DrawStart(const ResetConfig& config, ResetStage stage, std::uint64_t seed,
               std::uint32_t episode, Start* start);

/// The same in open water: distances and directions are horizontal, depths are uniform in the
/// ranges of `sea`, and targets move horizontally. All start 5 m or more from the bottom,
/// targets 5 m and vehicles 30 m or more from obstacles.
/// With reset.deploy, vehicles may also start in one place or anywhere.
void DrawSeaStart(const ResetConfig& config, const SeaConfig& sea, const Seascape& scape,
                  ResetStage stage, std::uint64_t seed, std::uint32_t episode, Start* start);

}  // namespace stg::dynamics

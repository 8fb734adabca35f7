#pragma once

#include <vector>

#include "auv_dynamics/targets/target_state.hpp"
#include "auv_dynamics/terrain/terrain.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"
#include "auv_dynamics/world/sea_config.hpp"

namespace stg::dynamics {

/// The bottom of a scenario in open water; of another one a flat one that nobody asks for.
/// @param region_m half the size of the square around the origin whose bottom is read. Throws
/// UserError when its bathymetry cannot be had (TerrainFile, Bathymetry::Load, Terrain).
Terrain TerrainOf(const SeaConfig& config, double region_m);

/// Surface and bottom of open water. A vehicle that reaches either stops there: its height is
/// clamped and the vertical part of its velocity, over ground, is taken from it; a slope does not
/// stop it, and where the bottom is above the surface it goes on along the surface, aground. Coming
/// to the bottom is an event, counted once until the vehicle is off it again.
class Sea {
 public:
  /// Throws as TerrainOf does.
  Sea(const SeaConfig& config, int vehicles, double region_m);

  /// An episode starts in one lane.
  void Reset(int lane);
  /// Keeps vehicle i between bottom and surface.
  void Apply(int i, VehicleState<Pack>* vehicle);
  /// Keeps targets within their depths.
  void Apply(std::vector<TargetState<Pack>>* targets) const;

  const Terrain& terrain() const { return terrain_; }
  /// How often vehicle i has come to the bottom in this episode, and whether it lies on it now (1).
  const Pack& groundings(int i) const { return groundings_[static_cast<std::size_t>(i)]; }
  const Pack& aground(int i) const { return aground_[static_cast<std::size_t>(i)]; }

 private:
  Pack Bottom(const Vec3<Pack>& p_WB) const;

  SeaConfig config_;
  Terrain terrain_;
  std::vector<Pack> groundings_, aground_;
};

}  // namespace stg::dynamics

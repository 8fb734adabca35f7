#pragma once

#include <vector>

#include "auv_dynamics/targets/target_state.hpp"
#include "auv_dynamics/terrain/seascape.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// Contacts of vehicles and targets with surface, bottom and obstacles of open water. A vehicle
/// that reaches surface or bottom stops there: its height is clamped, and the vertical part of its
/// velocity over ground becomes zero. A slope does not stop it, and where the bottom is above the
/// surface it continues along the surface, aground. A vehicle that meets an obstacle stays at its
/// surface and keeps the part of its velocity that does not lead into it. A contact with the bottom
/// or an obstacle counts once, until the vehicle is free again.
class Sea {
 public:
  /// @param region_m see Seascape, also for its errors
  Sea(const SeaConfig& config, int vehicles, double region_m);

  /// An episode starts in one lane.
  void Reset(int lane);
  /// Keeps vehicle i in the water.
  void Apply(int i, VehicleState<Pack>* vehicle);
  /// Keeps targets within their depths and out of bottom and obstacles, along which they slide.
  void Apply(std::vector<TargetState<Pack>>* targets) const;

  const Seascape& scape() const { return scape_; }
  const Terrain& terrain() const { return scape_.terrain; }
  /// How often vehicle i has reached the bottom in this episode, and whether it touches it now (1).
  const Pack& groundings(int i) const { return groundings_[static_cast<std::size_t>(i)]; }
  const Pack& aground(int i) const { return aground_[static_cast<std::size_t>(i)]; }
  /// How often it has reached an obstacle, and whether it touches one now (1).
  const Pack& collisions(int i) const { return collisions_[static_cast<std::size_t>(i)]; }
  const Pack& touching(int i) const { return touching_[static_cast<std::size_t>(i)]; }

 private:
  Pack Bottom(const Vec3<Pack>& p_WB) const;
  void MeetObstacles(int i, VehicleState<Pack>* vehicle);

  SeaConfig config_;
  Seascape scape_;
  std::vector<Pack> groundings_, aground_, collisions_, touching_;
};

}  // namespace stg::dynamics

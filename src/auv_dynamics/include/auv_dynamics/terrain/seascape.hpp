#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "auv_dynamics/terrain/sea_config.hpp"
#include "auv_dynamics/terrain/terrain.hpp"

namespace stg::dynamics {

/// Spheres, then cylinders, of the section.
std::vector<Obstacle> ObstaclesOf(const SeaConfig& config);

/// Fixed bodies in open water: the bottom and the obstacles.
struct Seascape {
  Terrain terrain;
  std::vector<Obstacle> obstacles;

  /// @param region_m half the size of the square around the origin whose bottom is read. Throws
  /// UserError when its bathymetry cannot be read (Bathymetry::Load, Terrain).
  Seascape(const SeaConfig& config, double region_m);

  /// Height of a point above the bottom [m]; negative inside it.
  double Altitude(const Vec3<double>& p_W) const { return terrain.Altitude(p_W); }
  /// Distance to the nearest obstacle [m], negative inside one; 1e9 without obstacles.
  double Clearance(const Vec3<double>& p_W) const;
  /// Whether nothing can be between two points in the water.
  bool clear() const { return terrain.flat() && obstacles.empty(); }
  bool Sees(const Vec3<double>& a, const Vec3<double>& b) const {
    return clear() || LineOfSight(terrain, obstacles, a, b);
  }
};

/// The line-of-sight test of a scenario's sea, for the acoustic channel; empty where all lines are
/// free. Throws as Seascape does.
std::function<bool(const Vec3<double>& a_W, const Vec3<double>& b_W)> ShadowsOf(
    const SeaConfig& config, double region_m);

}  // namespace stg::dynamics

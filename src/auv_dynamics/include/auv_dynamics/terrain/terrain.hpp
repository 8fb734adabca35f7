#pragma once

#include <optional>
#include <vector>

#include "auv_common/numbers/vector.hpp"
#include "auv_dynamics/terrain/bathymetry.hpp"
#include "auv_dynamics/terrain/datum.hpp"

namespace stg::dynamics {

/// A body in the water that blocks vehicles, sound and sight.
struct Obstacle {
  enum class Kind { kSphere, kCylinder };
  Kind kind = Kind::kSphere;
  Vec3<double> p_W;  ///< centre; of a cylinder, of its foot [m]
  double radius_m = 1.0;
  double height_m = 0.0;  ///< of a cylinder, which stands upright

  /// Distance of a point from its surface [m], negative inside.
  double Distance(const Vec3<double>& p_W) const;
  /// 1 where a point lies inside, else 0.
  Pack Inside(const Vec3<Pack>& p_W) const;
  /// Moves a point inside it to the nearest point of its surface; returns the outward direction
  /// there.
  Vec3<double> Expel(Vec3<double>* p_W) const;
  /// Whether it touches the segment from a to b.
  bool Blocks(const Vec3<double>& a, const Vec3<double>& b) const;
};

/// Bottom of the sea in the world's frame. Heights are of the world's z axis: the sea's surface is
/// z = 0, the bottom is below it.
class Terrain {
 public:
  /// A flat bottom at this depth [m].
  explicit Terrain(double depth_m);
  /// A grid around a datum, resampled on a square of 2 `half_size_m` with a spacing of at most half
  /// a cell of it, at least 1 m, and bilinear in between: at the points of that square it is the
  /// grid's own bilinear surface. The curvature of the sea is left out: heights above the ellipsoid
  /// are heights above z = 0.
  /// Throws UserError when the grid does not cover the square.
  Terrain(const Bathymetry& grid, const Datum& datum, double half_size_m);

  /// Height of the bottom [m]. Outside of the square it is the height at the edge.
  double Height(double x, double y) const;
  /// Height of a point above the bottom, straight down [m]; negative inside it.
  double Altitude(const Vec3<double>& p_W) const { return p_W.z - Height(p_W.x, p_W.y); }
  /// The highest point of the bottom [m].
  double highest() const { return highest_; }
  bool flat() const { return heights_.empty(); }
  double spacing_m() const { return spacing_; }

 private:
  double depth_ = 0.0, half_size_ = 0.0, spacing_ = 0.0, highest_ = 0.0;
  std::size_t side_ = 0;
  std::vector<float> heights_;  // [side_, side_], rows to the north
};

/// Whether neither bottom nor obstacle is between two points; the bottom is tested at every half
/// spacing of its grid along the segment. The result is the same from b to a. It is false for a
/// point inside the bottom or an obstacle.
bool LineOfSight(const Terrain& terrain, const std::vector<Obstacle>& obstacles,
                 const Vec3<double>& a, const Vec3<double>& b);

}  // namespace stg::dynamics

#pragma once

#include <memory>

#include "auv_common/numbers/vector.hpp"

namespace GeographicLib {
class LocalCartesian;
}

namespace stg::dynamics {

/// Place of the world's origin on the Earth: WGS 84 geodetic coordinates to the local tangent
/// frame ENU and back, by GeographicLib, exact to nanometres. Over 4 km the sea curves 0.3 m below
/// the tangent plane at the edges of the region; heights here are along the plane's normal.
class Datum {
 public:
  /// Throws UserError for a latitude beyond +-90 or a longitude beyond +-540.
  Datum(double latitude_deg, double longitude_deg);
  ~Datum();
  Datum(Datum&&) noexcept;

  /// World position [m] of a point at `height_m` above the ellipsoid.
  Vec3<double> ToWorld(double latitude_deg, double longitude_deg, double height_m) const;
  struct Geodetic {
    double latitude_deg, longitude_deg, height_m;
  };
  Geodetic ToGeodetic(const Vec3<double>& p_W) const;

 private:
  std::unique_ptr<const GeographicLib::LocalCartesian> frame_;
};

}  // namespace stg::dynamics

#include "auv_dynamics/terrain/datum.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <string>

#include "auv_common/error.hpp"

namespace stg::dynamics {

Datum::Datum(double latitude_deg, double longitude_deg) {
  if (!(std::abs(latitude_deg) <= 90.0) || !(std::abs(longitude_deg) <= 540.0)) {
    throw UserError("datum: this is not a place on Earth: latitude " +
                    std::to_string(latitude_deg) + ", longitude " + std::to_string(longitude_deg));
  }
  frame_ = std::make_unique<const GeographicLib::LocalCartesian>(latitude_deg, longitude_deg, 0.0);
}

Datum::~Datum() = default;
Datum::Datum(Datum&&) noexcept = default;

Vec3<double> Datum::ToWorld(double latitude_deg, double longitude_deg, double height_m) const {
  Vec3<double> p;
  frame_->Forward(latitude_deg, longitude_deg, height_m, p.x, p.y, p.z);
  return p;
}

Datum::Geodetic Datum::ToGeodetic(const Vec3<double>& p) const {
  Geodetic g{};
  frame_->Reverse(p.x, p.y, p.z, g.latitude_deg, g.longitude_deg, g.height_m);
  return g;
}

}  // namespace stg::dynamics

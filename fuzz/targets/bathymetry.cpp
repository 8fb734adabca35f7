#include "auv_dynamics/terrain/bathymetry.hpp"

#include <cmath>

#include "target.hpp"

/// A bathymetry file. An accepted one has elevations everywhere.
bool stg::fuzz::RunBathymetry(const std::string& bytes) {
  return LoadAsFile(bytes, [](const std::string& path) {
    const auto sea = dynamics::Bathymetry::Load(path);
    const dynamics::GeoRegion r = sea.region();
    const double middle = sea.At((r.south + r.north) / 2.0, (r.west + r.east) / 2.0);
    Require(std::isfinite(middle) && middle >= sea.lowest() && middle <= sea.highest(),
            "an elevation outside of what the grid holds");
  });
}

#include "auv_dynamics/terrain/seascape.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"

namespace stg::dynamics {
namespace {

/// Makes the terrain of a scenario in open water. Other scenarios have no terrain.
Terrain MakeTerrain(const SeaConfig& c, double region_m) {
  if (!c.open || c.terrain == "flat") return Terrain(c.bottom_m);
  // Slightly more than the region, because the region is a square in metres, not in degrees.
  const Datum datum(c.latitude_deg, c.longitude_deg);
  const Datum::Geodetic corners[] = {
      datum.ToGeodetic({-region_m, -region_m, 0.0}), datum.ToGeodetic({region_m, -region_m, 0.0}),
      datum.ToGeodetic({-region_m, region_m, 0.0}),  datum.ToGeodetic({region_m, region_m, 0.0}),
      datum.ToGeodetic({0.0, -region_m, 0.0}),       datum.ToGeodetic({0.0, region_m, 0.0})};
  GeoRegion r{90.0, -90.0, c.longitude_deg, c.longitude_deg};
  for (const Datum::Geodetic& at : corners) {
    const double longitude =
        c.longitude_deg + std::remainder(at.longitude_deg - c.longitude_deg, 360.0);
    r = {std::min(r.south, at.latitude_deg), std::max(r.north, at.latitude_deg),
         std::min(r.west, longitude), std::max(r.east, longitude)};
  }
  return Terrain(Bathymetry::Load(TerrainFile(c.terrain), r), datum, region_m);
}

}  // namespace

std::string TerrainFile(const std::string& name) {
  std::error_code error;  // a link to itself is not a file
  const auto is_file = [&error](const std::string& path) {
    return std::filesystem::is_regular_file(path, error);
  };
  if (std::filesystem::path(name).extension() == ".nc") {
    if (is_file(name)) return name;
    throw UserError("sea.terrain: no file " + name);
  }
  const char* own = std::getenv("STG_TERRAINS");
  std::istringstream folders(own == nullptr ? "" : own);
  std::string file;
  for (std::string folder; std::getline(folders, folder, ':');) {
    file = folder + "/" + name + ".nc";
    if (!folder.empty() && is_file(file)) return file;
  }
  file = config::ScenarioFolder() + "/../terrain/" + name + ".nc";
  if (is_file(file)) return file;
  throw UserError("sea.terrain: no " + name + ".nc in the folders of STG_TERRAINS (" +
                  (own == nullptr ? "not set" : own) + "), and no " + file);
}

std::vector<Obstacle> ObstaclesOf(const SeaConfig& c) {
  std::vector<Obstacle> all;
  for (const auto& row : c.spheres) {
    all.push_back({Obstacle::Kind::kSphere, {row[0], row[1], row[2]}, row[3], 0.0});
  }
  for (const auto& row : c.cylinders) {
    all.push_back({Obstacle::Kind::kCylinder, {row[0], row[1], row[2]}, row[3], row[4]});
  }
  return all;
}

Seascape::Seascape(const SeaConfig& config, double region_m)
    : terrain(MakeTerrain(config, region_m)), obstacles(ObstaclesOf(config)) {}

double Seascape::Clearance(const Vec3<double>& p_W) const {
  double nearest = 1e9;
  for (const Obstacle& o : obstacles) nearest = std::min(nearest, o.Distance(p_W));
  return nearest;
}

std::function<bool(const Vec3<double>&, const Vec3<double>&)> ShadowsOf(const SeaConfig& config,
                                                                        double region_m) {
  if (!config.open) return {};
  const auto scape = std::make_shared<const Seascape>(config, region_m);
  if (scape->clear()) return {};
  return [scape](const Vec3<double>& a, const Vec3<double>& b) { return scape->Sees(a, b); };
}

}  // namespace stg::dynamics

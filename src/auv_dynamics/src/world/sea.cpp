#include "auv_dynamics/world/sea.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"

namespace stg::dynamics {

Terrain TerrainOf(const SeaConfig& c, double region_m) {
  if (!c.open || c.terrain == "flat") return Terrain(c.bottom_m);
  // A little more than the region, which is a square of metres and not of degrees.
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

std::string TerrainFile(const std::string& name) {
  if (std::filesystem::path(name).extension() == ".nc") {
    if (std::filesystem::is_regular_file(name)) return name;
    throw UserError("sea.terrain: no file " + name);
  }
  const char* own = std::getenv("STG_TERRAINS");
  std::istringstream folders(own == nullptr ? "" : own);
  std::string file;
  for (std::string folder; std::getline(folders, folder, ':');) {
    file = folder + "/" + name + ".nc";
    if (!folder.empty() && std::filesystem::is_regular_file(file)) return file;
  }
  file = config::ScenarioFolder() + "/../terrain/" + name + ".nc";
  if (std::filesystem::is_regular_file(file)) return file;
  throw UserError("sea.terrain: no " + name + ".nc in the folders of STG_TERRAINS (" +
                  (own == nullptr ? "not set" : own) + "), and no " + file);
}

using config::kNone;
using config::NonNegative;
using config::Positive;

void Describe(SeaConfig* c, config::Table* t) {
  t->Section("sea");
  t->AddOptional("open", &c->open, "false", kNone, "-",
                 "open water: a surface at z = 0 and a bottom instead of the walls");
  t->AddOptional(
      "terrain", &c->terrain, "flat", kNone, "-",
      "bottom of open water: flat, or a bathymetry: a FILE.nc, or a NAME whose file NAME.nc is in a "
      "folder of $STG_TERRAINS or shipped");
  t->AddOptional("bottom_m", &c->bottom_m, "120.0", Positive(12000), "m",
                 "depth of the flat bottom");
  t->AddOptional("latitude_deg", &c->latitude_deg, "0.0", config::Within(-90, 90), "deg, WGS 84",
                 "latitude of the world's origin");
  t->AddOptional("longitude_deg", &c->longitude_deg, "0.0", config::Within(-360, 360),
                 "deg, WGS 84", "longitude of the world's origin");
  t->AddOptional("auv_depth_m", &c->auv_depth_m, "[20.0, 60.0]", NonNegative(12000), "m",
                 "[low, high] depth at which an AUV starts in open water");
  t->AddOptional("target_depth_m", &c->target_depth_m, "[20.0, 60.0]", NonNegative(12000), "m",
                 "[low, high] depth at which a target starts and stays in open water");
}

std::optional<config::Violation> FindConflict(const SeaConfig& c) {
  if (!c.open || c.terrain != "flat") return {};
  if (c.auv_depth_m.hi >= c.bottom_m) {
    return config::Violation{{"sea.auv_depth_m", "sea.bottom_m"}, "AUVs would start in the bottom"};
  }
  if (c.target_depth_m.hi >= c.bottom_m) {
    return config::Violation{{"sea.target_depth_m", "sea.bottom_m"},
                             "targets would start in the bottom"};
  }
  return {};
}

Sea::Sea(const SeaConfig& config, int vehicles, double region_m)
    : config_(config),
      terrain_(TerrainOf(config, region_m)),
      groundings_(static_cast<std::size_t>(vehicles), Pack(0.0)),
      aground_(groundings_) {}

void Sea::Reset(int lane) {
  for (Pack& x : groundings_) SetLane(&x, lane, 0.0);
  for (Pack& x : aground_) SetLane(&x, lane, 0.0);
}

Pack Sea::Bottom(const Vec3<Pack>& p_WB) const {
  if (terrain_.flat()) return Pack(-config_.bottom_m);
  Pack bottom(0.0);
  for (int lane = 0; lane < kLanes; ++lane) {
    SetLane(&bottom, lane, terrain_.Height(Lane(p_WB.x, lane), Lane(p_WB.y, lane)));
  }
  return bottom;
}

void Sea::Apply(int i, VehicleState<Pack>* s) {
  const Pack zero(0.0), one(1.0), bottom = Bottom(s->p_WB);
  const auto below = s->p_WB.z < bottom;
  const auto above = s->p_WB.z > zero;
  Pack& aground = aground_[static_cast<std::size_t>(i)];
  Pack& groundings = groundings_[static_cast<std::size_t>(i)];
  // Who lies on the bottom and does not rise stays aground; only coming there counts.
  const auto on = below || (s->p_WB.z == bottom && aground > zero);
  groundings += Select(below, one - aground, zero);
  aground = Select(on, one, zero);
  if (!Any(below || above)) return;
  s->p_WB.z = Min(Max(s->p_WB.z, bottom), zero);
  const Pack climb = s->v_WB.z;
  s->v_WB.z = Select(below, Max(climb, zero), Select(above, Min(climb, zero), climb));
  s->v_WB_B = Select(below || above, s->R_WB.TransposeTimes(s->v_WB), s->v_WB_B);
}

void Sea::Apply(std::vector<TargetState<Pack>>* targets) const {
  const Pack lo(-config_.target_depth_m.hi), hi(-config_.target_depth_m.lo), zero(0.0);
  for (TargetState<Pack>& t : *targets) {
    const auto outward = (t.p_WT.z < lo && t.v_WT.z < zero) || (t.p_WT.z > hi && t.v_WT.z > zero);
    t.p_WT.z = Min(Max(t.p_WT.z, lo), hi);
    // It levels out, and its motion steers on from there.
    t.v_WT.z = Select(outward, -t.v_WT.z, t.v_WT.z);
  }
}

}  // namespace stg::dynamics

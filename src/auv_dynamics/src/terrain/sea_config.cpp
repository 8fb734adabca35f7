#include "auv_dynamics/terrain/sea_config.hpp"

namespace stg::dynamics {

using config::kNone;
using config::NonNegative;
using config::Positive;
using config::Within;

namespace {

std::vector<std::string> WaterOf(const SeaConfig& c) { return {c.open ? "open water" : "walls"}; }

}  // namespace

config::Owner WallsOwner(const SeaConfig* c) {
  return {"world", {"walls"}, "sea.open", [c] { return WaterOf(*c); }};
}

void Describe(SeaConfig* c, config::Table* t) {
  t->Section("sea");
  t->AddOptional("open", &c->open, "false", kNone, "-",
                 "open water: a surface at z = 0 and a bottom instead of the walls");
  t->AddOptional("terrain", config::NameOrFileRef{&c->terrain, ".nc"}, "flat", kNone,
                 "name or FILE.nc",
                 "bottom of open water: flat, or a bathymetry: a FILE.nc, or the NAME of a file "
                 "NAME.nc that is shipped or in a folder of $STG_TERRAINS");
  t->AddOptional("bottom_m", &c->bottom_m, "120.0", Positive(12000), "m",
                 "depth of the flat bottom; over a terrain, the depth that policies over entities "
                 "take the bottom to have");
  t->AddOptional("latitude_deg", &c->latitude_deg, "0.0", Within(-90, 90), "deg, WGS 84",
                 "latitude of the world's origin");
  t->AddOptional("longitude_deg", &c->longitude_deg, "0.0", Within(-360, 360), "deg, WGS 84",
                 "longitude of the world's origin");
  t->AddOptional("auv_depth_m", &c->auv_depth_m, "[20.0, 60.0]", NonNegative(12000), "m",
                 "[low, high] depth at which an AUV starts in open water");
  t->AddOptional("target_depth_m", &c->target_depth_m, "[20.0, 60.0]", NonNegative(12000), "m",
                 "[low, high] depth at which a target starts and stays in open water");
  t->AddOptional("spheres", config::RowsRef{&c->spheres, 4}, "[]", Within(-1e5, 1e5),
                 "m, world ENU", "obstacles in open water: [x, y, z, radius] each");
  t->AddOptional("cylinders", config::RowsRef{&c->cylinders, 5}, "[]", Within(-1e5, 1e5),
                 "m, world ENU",
                 "upright obstacles in open water: [x, y, z of the foot, radius, height] each");
  t->Own("sea", {"world", {"open water"}, "sea.open", [c] { return WaterOf(*c); }});
  t->AlsoReadIf("sea.open", [] { return true; });
}

std::optional<config::Violation> FindConflict(const SeaConfig& c) {
  for (const auto& row : c.spheres) {
    if (!(row[3] > 0.0)) return config::Violation{{"sea.spheres"}, "a radius must be positive"};
  }
  for (const auto& row : c.cylinders) {
    if (!(row[3] > 0.0 && row[4] > 0.0)) {
      return config::Violation{{"sea.cylinders"}, "a radius and a height must be positive"};
    }
  }
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

}  // namespace stg::dynamics

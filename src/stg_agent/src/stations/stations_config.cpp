#include "stg_agent/stations/stations_config.hpp"

#include <string>
#include <vector>

namespace stg::agent {

using config::kNone;
using config::Positive;
using config::Within;

void Describe(StationsConfig* c, config::Table* t) {
  t->Section("stations");
  t->AddOptional("beacons", config::RowsRef{&c->beacons, 3}, "[]", Within(-1e5, 1e5),
                 "m, world ENU", "fixed beacons: charted position [x, y, z] of each");
  t->AddOptional("survey_std_m", &c->survey_std_m, "1.0", config::NonNegative(1e3), "m, world ENU",
                 "standard deviation of each horizontal component of a charted position, drawn per "
                 "episode");
  t->AddOptional("crafts", config::RowsRef{&c->crafts, 2}, "[]", Within(-1e5, 1e5), "m, world ENU",
                 "surface craft: start position [x, y] of each");
  t->AddOptional("craft_speed_mps", &c->craft_speed_mps, "1.5", Positive(50), "m/s",
                 "speed over ground of a craft");
  t->AddOptional("craft_circle_m", &c->craft_circle_m, "300.0", Positive(1e5), "m",
                 "radius of the circle on which a craft moves around the AUVs that it heard");
  t->AddOptional("gps_std_m", &c->gps_std_m, "2.0", Positive(1e3), "m, world ENU",
                 "standard deviation of each horizontal component of a craft's position");
  t->AddOptional("gps_memory_s", &c->gps_memory_s, "600.0", Positive(1e6), "s",
                 "correlation time of that error");
  t->AddOptional(
      "usbl_std_deg", &c->usbl_std_deg, "0.0", Within(0.0, 60.0), "deg",
      "standard deviation of the bearing of a received packet that a station measures with an "
      "ultra-short baseline and a compass and sends to the AUVs; 0: stations measure no bearings");
  const auto owner = [](const char* name, const std::vector<std::vector<double>>* rows) {
    const std::string key = std::string("stations.") + name;
    return config::Owner{"stations", {name}, key, [name, rows] {
                           return std::vector<std::string>{rows->empty() ? "none" : name};
                         }};
  };
  t->Own("stations.usbl_std_deg", {"stations",
                                   {"beacons", "crafts"},
                                   "stations.crafts",
                                   [c] {
                                     std::vector<std::string> names;
                                     if (!c->beacons.empty()) names.emplace_back("beacons");
                                     if (!c->crafts.empty()) names.emplace_back("crafts");
                                     return names;
                                   },
                                   {"stations.beacons"}});
  t->Own("stations.survey_std_m", owner("beacons", &c->beacons));
  for (const char* key : {"craft_speed_mps", "craft_circle_m", "gps_std_m", "gps_memory_s"}) {
    t->Own(std::string("stations.") + key, owner("crafts", &c->crafts));
  }
}

RunConfig NetworkRun(const RunConfig& run, const StationsConfig& stations, int transponders) {
  RunConfig network = run;
  network.agents += stations.count() + transponders;
  network.transponders = transponders;
  network.timekeepers = static_cast<int>(stations.crafts.size());
  return network;
}

}  // namespace stg::agent

#include "stg_agent/estimation/track_config.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "stg_agent/estimation/target_filter.hpp"

namespace stg::agent {

namespace {

void DescribeMeasurements(TrackConfig* c, config::Table* t) {
  t->Add("velocity_std_mps", &c->velocity_std_mps, config::NonNegative(100), "m/s",
         "standard deviation of each component of the target's velocity; 0: target.max_speed_mps / "
         "sqrt(2)");
  t->Add("velocity_memory_s", &c->velocity_memory_s, config::Positive(1e5), "s",
         "correlation time of the target's velocity");
  t->Add("memory_s", &c->memory_s, config::Positive(1e5), "s",
         "largest age of a measurement that the filter uses");
  t->Add("share_spacing_s", &c->share_spacing_s, config::NonNegative(1e5), "s",
         "least time between the two measurements in one packet");
  t->Add("observers", config::Enum(&c->observers, {"steps", "rates", "located"}), config::kNone,
         "-",
         "errors of the observers' positions. steps: they grow by independent steps; rates: they "
         "grow at lasting rates while the logs do not reach the bottom; located: localization.kind "
         "states them");
  t->Add("shear_std_mps", &c->shear_std_mps, config::NonNegative(10), "m/s",
         "rates: standard deviation of each component of the current that an AUV does not "
         "share with the others");
  t->Add("shear_memory_s", &c->shear_memory_s, config::Positive(1e7), "s",
         "rates: correlation time of that current");
}

}  // namespace

void Describe(TrackConfig* c, config::Table* t) {
  t->Section("track");
  t->Add("process_accel_std_mps2", &c->process_accel_std_mps2, config::Positive(100), "m/s^2",
         "acoustic mode: white acceleration of the target model");
  t->Add("measurement_std_m", &c->measurement_std_m, config::Positive(1e4), "m",
         "smallest standard deviation given to a detection");
  t->Add("initial_speed_std_mps", &c->initial_speed_std_mps, config::Positive(100), "m/s",
         "standard deviation of each velocity component of a new track");
  t->Add("gate_sigma", &c->gate_sigma, config::Positive(1e3), "-",
         "the filter rejects own detections farther off than so many standard deviations; three in "
         "a row restart the track");
  t->Add("lost_std_m", &c->lost_std_m, config::Positive(1e4), "m",
         "a track counts as lost when the standard deviation of its position is above this");
  t->Add("neighbour_max_age_s", &c->neighbour_max_age_s, config::Positive(1e5), "s",
         "an AUV forgets a neighbour that has been silent for this time");
  t->AddOptional("search_cell_m", &c->search_cell_m, "0.0", config::NonNegative(1e4), "m",
                 "side of a cell of each agent's search map, 32 x 32 cells around the datum that "
                 "give the probability of its target; 0: no map");
  t->AddOptional("filter", config::Name(&c->filter, TargetFilters().Names()), "kalman",
                 config::kNone, "-",
                 "target filter. kalman: uses positions and shared estimates; measurements: uses "
                 "measurements of any kind");
  const auto chosen = [c] { return std::vector<std::string>{c->filter}; };
  t->Thing({"target filter", {"measurements"}, "track.filter", chosen}, "track.measurements", c,
           DescribeMeasurements);
  TargetFilters().Describe("track", "track.filter", chosen, &c->filters, t);
  // A registered filter may read the keys of the filter `kalman`, too.
  std::vector<std::string> others = TargetFilters().Names();
  others.erase(std::find(others.begin(), others.end(), "measurements"));
  for (const char* key : {"process_accel_std_mps2", "initial_speed_std_mps", "gate_sigma"}) {
    // Files state them also for other filters, because a command may choose `kalman`.
    t->Own(std::string("track.") + key,
           {"target filter", others, "track.filter", chosen, {}, true});
  }
  for (const char* key : {"shear_std_mps", "shear_memory_s"}) {
    t->Own(std::string("track.measurements.") + key,
           {"observers' errors", {"rates"}, "track.measurements.observers", [c] {
              const char* const names[] = {"steps", "rates", "located"};
              return std::vector<std::string>{names[static_cast<int>(c->observers)]};
            }});
  }
  t->Own("track.measurements.shear_memory_s",
         {"shear", {"on"}, "track.measurements.shear_std_mps", [c] {
            return std::vector<std::string>{c->shear_std_mps > 0.0 ? "on" : "off"};
          }});
  for (const char* key : {"velocity_std_mps", "velocity_memory_s", "memory_s", "share_spacing_s",
                          "observers", "shear_std_mps", "shear_memory_s"}) {
    t->Moved(std::string("track.") + key, std::string("track.measurements.") + key);
  }
}

}  // namespace stg::agent

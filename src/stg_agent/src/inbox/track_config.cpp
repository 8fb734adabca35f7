#include "stg_agent/inbox/track_config.hpp"

namespace stg::agent {

void Describe(TrackConfig* c, config::Table* t) {
  t->Section("track");
  t->Add("process_accel_std_mps2", &c->process_accel_std_mps2, config::Positive(100), "m/s^2",
         "acoustic mode: white acceleration of the target model");
  t->Add("measurement_std_m", &c->measurement_std_m, config::Positive(1e4), "m",
         "smallest standard deviation given to a detection");
  t->Add("initial_speed_std_mps", &c->initial_speed_std_mps, config::Positive(100), "m/s",
         "standard deviation of each velocity component of a new track");
  t->Add("gate_sigma", &c->gate_sigma, config::Positive(1e3), "-",
         "own detections farther off are set aside, three in a row restart the track");
  t->Add("lost_std_m", &c->lost_std_m, config::Positive(1e4), "m",
         "a track whose position is no better than this counts as lost");
  t->Add("neighbour_max_age_s", &c->neighbour_max_age_s, config::Positive(1e5), "s",
         "a neighbour is forgotten after this silence");
}

}  // namespace stg::agent

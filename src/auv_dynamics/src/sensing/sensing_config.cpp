#include "auv_dynamics/sensing/sensing_config.hpp"

#include "auv_dynamics/sensing/target_sensor.hpp"

namespace stg::dynamics {

using config::kFraction;
using config::NonNegative;
using config::Positive;

void Describe(SensingConfig* c, config::Table* t) {
  t->Section("sensing");
  t->Add("sensor", config::Name(&c->sensor, TargetSensors().Names()), config::kNone, "-",
         "what an AUV's own sensor measures of a target");
  t->Add("range_m", &c->range_m, config::Positive(1e5), "m",
         "R_s: detection range, and scale of the confidence of Eq. 13");
  t->Add("noise_std_m", &c->noise_std_m, config::NonNegative(1e4), "m, world ENU",
         "standard deviation of each component of a detection");
  t->Add("detection_probability", &c->detection_probability, config::kFraction, "-",
         "chance of a detection per decision within range");
  t->Add("dropout_rate_hz", &c->dropout_rate_hz, config::NonNegative(1e3), "Hz",
         "rate at which a sensor goes blind; 0: never");
  t->Add("dropout_duration_s", &c->dropout_duration_s, config::Positive(1e5), "s",
         "mean duration of a blind spell");
  t->Add("cue_std_m", &c->cue_std_m, config::NonNegative(1e4), "m, world ENU",
         "acoustic mode: standard deviation of each component of the initial datum");
}

}  // namespace stg::dynamics

#include "auv_dynamics/sensing/sensing_config.hpp"

#include <cmath>

#include "auv_dynamics/sensing/target_sensor.hpp"

namespace stg::dynamics {

using config::kFraction;
using config::kNone;
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
  t->AddOptional("period_s", &c->period_s, "0.0", NonNegative(1e5), "s",
                 "time between two looks, whole decisions; 0: every decision");
  t->AddOptional("range_std_m", &c->range_std_m, "1.0", Positive(1e4), "m",
                 "range, range_bearing: a of the standard deviation a + b r");
  t->AddOptional("range_std_share", &c->range_std_share, "0.01", config::kFraction, "-",
                 "range, range_bearing: b of the standard deviation a + b r");
  t->AddOptional("bearing_std_deg", &c->bearing_std_deg, "2.0", Positive(60), "deg",
                 "bearing, range_bearing: standard deviation of azimuth and elevation");
  t->AddOptional("probability_at_range", &c->probability_at_range, "1.0", config::kFraction, "-",
                 "share of the detection probability that is left at the detection range, falling "
                 "with the square of the range; not of position");
  t->AddOptional("outlier_probability", &c->outlier_probability, "0.0", config::kFraction, "-",
                 "chance that a detection is drawn from anywhere in range; not of position");
  t->AddOptional("false_alarm_probability", &c->false_alarm_probability, "0.0", config::kFraction,
                 "-", "chance that a look without a detection tells of one; not of position");
  t->AddOptional("field_of_view_deg", &c->field_of_view_deg, "360.0", Positive(360), "deg, body",
                 "full angle of the cone around the bow that is seen; not of position");
  t->AddOptional("ambiguous", &c->ambiguous, "false", kNone, "-",
                 "bearing, range_bearing: cannot tell port from starboard, as a line array");
}

std::optional<config::Violation> FindConflict(const SensingConfig& c, double decision_dt_s) {
  const double looks = c.period_s / decision_dt_s;
  if (std::abs(looks - std::round(looks)) > 1e-6) {
    return config::Violation{{"sensing.period_s", "time.decision_steps"},
                             "the period must be a whole number of decisions"};
  }
  return {};
}

}  // namespace stg::dynamics

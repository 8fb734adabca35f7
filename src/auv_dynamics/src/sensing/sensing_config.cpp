#include "auv_dynamics/sensing/sensing_config.hpp"

#include <cmath>

#include "auv_common/config/run_config.hpp"
#include "auv_dynamics/sensing/target_sensor.hpp"

namespace stg::dynamics {

using config::kFraction;
using config::kNone;
using config::NonNegative;
using config::Positive;

void Describe(RelativeOptions* o, config::Table* t) {
  if (o->has_range) {
    t->Add("range_std_m", &o->range_std_m, Positive(1e4), "m",
           "a of the standard deviation a + b r of a range r");
    t->Add("range_std_share", &o->range_std_share, kFraction, "-",
           "b of the standard deviation a + b r of a range r");
  }
  if (o->has_bearing) {
    t->Add("bearing_std_deg", &o->bearing_std_deg, Positive(60), "deg",
           "standard deviation of azimuth and elevation");
    t->Add("ambiguous", &o->ambiguous, kNone, "-",
           "bearings do not distinguish port from starboard, as with a line array");
  }
  t->Add("probability_at_range", &o->probability_at_range, kFraction, "-",
         "share of the detection probability that remains at the detection range; the probability "
         "falls with the square of the range");
  t->Add("outlier_probability", &o->outlier_probability, kFraction, "-",
         "probability that a detection is drawn from anywhere within range");
  t->Add("false_alarm_probability", &o->false_alarm_probability, kFraction, "-",
         "probability of a false detection in a look that detects nothing");
  t->Add("field_of_view_deg", &o->field_of_view_deg, Positive(360), "deg, body",
         "full angle of the cone around the bow in which the sensor detects");
}

void Describe(SensingConfig* c, config::Table* t) {
  t->Section("sensing");
  t->Add("sensor", config::Name(&c->sensor, TargetSensors().Names()), config::kNone, "-",
         "what an AUV's own sensor measures of a target");
  t->Add("range_m", &c->range_m, config::Positive(1e5), "m",
         "R_s: detection range, and scale of the confidence of Eq. 13");
  t->Add("detection_probability", &c->detection_probability, config::kFraction, "-",
         "probability of a detection per decision within range");
  t->Add("dropout_rate_hz", &c->dropout_rate_hz, config::NonNegative(1e3), "Hz",
         "rate at which a sensor goes blind; 0: never");
  t->Add("dropout_duration_s", &c->dropout_duration_s, config::Positive(1e5), "s",
         "mean duration of a blind spell");
  t->Own("sensing.dropout_duration_s",
         {"target sensor", {"with blind spells"}, "sensing.dropout_rate_hz", [c] {
            return std::vector<std::string>{c->dropout_rate_hz > 0.0 ? "with blind spells"
                                                                     : "without blind spells"};
          }});
  t->Add("cue_std_m", &c->cue_std_m, config::NonNegative(1e4), "m, world ENU",
         "acoustic mode: standard deviation of each component of the initial datum");
  t->AddOptional("period_s", &c->period_s, "0.0", NonNegative(1e5), "s",
                 "time between two looks, whole decisions; 0: every decision");
  t->AddOptional("ranging", config::Enum(&c->ranging, {"free", "ping"}), "free", kNone, "-",
                 "cost of a range of the sensor `range`. free: none; ping: the AUV's modem pings "
                 "the target's transponder, which takes time on the channel and energy");
  t->AddOptional("labelled", &c->labelled, "true", kNone, "-",
                 "a detection says which target it is of. false: it does not, nor whether it is a "
                 "false alarm, and each AUV assigns its detections to its estimates");
  const auto sensor = [c] { return std::vector<std::string>{c->sensor}; };
  t->Thing({"target sensor", {"position"}, "sensing.sensor", sensor}, "sensing.position", c,
           [](SensingConfig* o, config::Table* table) {
             table->Add("noise_std_m", &o->noise_std_m, config::NonNegative(1e4), "m, world ENU",
                        "standard deviation of each component of a detection");
           });
  TargetSensors().Describe("sensing", "sensing.sensor", sensor, &c->sensors, t);
  t->Moved("sensing.noise_std_m", "sensing.position.noise_std_m");
  for (const char* key : {"range_std_m", "range_std_share", "probability_at_range",
                          "outlier_probability", "false_alarm_probability", "field_of_view_deg"}) {
    t->Moved(std::string("sensing.") + key, std::string("sensing.range.") + key);
  }
  for (const char* key : {"bearing_std_deg", "ambiguous"}) {
    t->Moved(std::string("sensing.") + key, std::string("sensing.bearing.") + key);
  }
}

std::optional<config::Violation> FindConflict(const SensingConfig& c, double decision_dt_s) {
  if (!IsWholeDecisions(c.period_s, decision_dt_s)) {
    return config::Violation{{"sensing.period_s", "time.decision_steps"},
                             "the period must be a whole number of decisions"};
  }
  if (!c.pings()) return {};
  if (!c.labelled) {
    return config::Violation{{"sensing.labelled", "sensing.ranging"},
                             "the answer to a ping says which transponder sent it"};
  }
  if (TargetSensors().Make(c.sensor, c.sensors, c)->kind() != MeasurementKind::kRange) {
    return config::Violation{{"sensing.ranging", "sensing.sensor"},
                             "a ping measures only a range, so the sensor must measure ranges"};
  }
  const RelativeOptions o = c.relative();
  if (c.dropout_rate_hz > 0.0 || o.outlier_probability > 0.0 || o.false_alarm_probability > 0.0 ||
      o.field_of_view_deg < 360.0) {
    return config::Violation{
        {"sensing.ranging", "sensing.dropout_rate_hz", "sensing.range.outlier_probability",
         "sensing.range.false_alarm_probability", "sensing.range.field_of_view_deg"},
        "these keys have no effect on a ping: it is heard in all directions, and is lost or late "
        "as packets are (channel.physical.modem.late_probability)"};
  }
  return {};
}

}  // namespace stg::dynamics

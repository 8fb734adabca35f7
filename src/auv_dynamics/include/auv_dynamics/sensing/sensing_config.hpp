#pragma once

#include <optional>
#include <string>

#include "auv_common/config/options.hpp"

namespace stg::dynamics {

/// Options of the sensors `range`, `bearing` and `range_bearing`; docs/sensors.md gives the sources
/// of the numbers.
struct RelativeOptions {
  bool has_range = true, has_bearing = true;  ///< whether these keys exist
  double range_std_m = 1.0;                   ///< a of the deviation a + b r of a range
  double range_std_share = 0.01;              ///< b of it
  double bearing_std_deg = 2.0;               ///< of azimuth and elevation
  double probability_at_range = 1.0;     ///< share of detection_probability that remains at range_m
  double outlier_probability = 0.0;      ///< that a detection is drawn from anywhere in range
  double false_alarm_probability = 0.0;  ///< of a false detection in a look without one
  double field_of_view_deg = 360.0;      ///< full angle around the bow
  bool ambiguous = false;                ///< bearings do not distinguish port from starboard

  /// Probability of a detection at a share of the detection range.
  double chance(double detection_probability, double share) const {
    return detection_probability * (1.0 - (1.0 - probability_at_range) * share * share);
  }
  /// Standard deviation of a range [m].
  double range_std(double range_m) const { return range_std_m + range_std_share * range_m; }
};
void Describe(RelativeOptions* o, config::Table* t);

/// Cost of a range to a target.
enum class Ranging {
  kFree,  ///< none: the sensor does not use the acoustic channel
  kPing   ///< a ping of the AUV's modem, which the target's transponder answers
};

/// The agents' own target sensor.
struct SensingConfig {
  std::string sensor = "position";  ///< name in the registry of target sensors
  double range_m = 0.45;            ///< R_s: detection range and confidence scale (Eq. 13)
  double noise_std_m = 0.0;         ///< position: per component
  double detection_probability = 1.0;
  double dropout_rate_hz = 0.0;        ///< rate at which the sensor goes blind
  double dropout_duration_s = 1.0;     ///< mean duration of a blind spell
  double cue_std_m = 0.05;             ///< uncertainty of the initial datum, per component
  double period_s = 0.0;               ///< between two looks; 0: every decision
  config::OptionsByName sensors = {};  ///< options of each one except `position`
  Ranging ranging = Ranging::kFree;
  bool labelled = true;  ///< detections say which target they are of

  bool pings() const { return ranging == Ranging::kPing; }
  RelativeOptions relative() const { return sensors.Get<RelativeOptions>(sensor); }
};

/// Keys, units and ranges of the section.
void Describe(SensingConfig* c, config::Table* t);
/// Contradictions between its keys. @param decision_dt_s length of a decision
std::optional<config::Violation> FindConflict(const SensingConfig& c, double decision_dt_s);

}  // namespace stg::dynamics

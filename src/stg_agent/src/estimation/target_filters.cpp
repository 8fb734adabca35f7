#include <limits>

#include "acoustic_channel/models/propagation_model.hpp"
#include "auv_dynamics/navigation/navigation_system.hpp"
#include "auv_dynamics/sensing/target_sensor.hpp"
#include "stg_agent/estimation/target_filter.hpp"

namespace stg::agent {

FilterRegistry& TargetFilters() {
  static FilterRegistry registry("target filter",
                                 {
                                     STG_ENTRY(FilterRegistry, KalmanFilterEntry),
                                     STG_ENTRY(FilterRegistry, MeasurementFilterEntry),
                                 });
  return registry;
}

std::unique_ptr<TargetFilter> MakeFilter(const AgentModel& model, int self) {
  return TargetFilters().Make(model.track.filter, model.track.filters, model, self);
}

PacketLayout LayoutOf(const AgentModel& model) { return MakeFilter(model, 0)->layout(); }

std::optional<config::Violation> FindFilterConflict(const AgentModel& model) {
  const auto filter = MakeFilter(model, 0);
  const auto sensor =
      dynamics::TargetSensors().Make(model.sensing.sensor, model.sensing.sensors, model.sensing);
  if (!filter->Takes(sensor->kind(), model.sensing.relative().ambiguous)) {
    return config::Violation{{"track.filter", "sensing.sensor"},
                             "this filter cannot use the measurements of this sensor"};
  }
  if (model.sensing.labelled || filter->Associates()) return {};
  return config::Violation{{"sensing.labelled", "track.filter"},
                           "this filter cannot compare a detection with its estimate: set "
                           "track.filter to measurements"};
}

namespace {

/// Ranges from travel times need clocks that are right, or an estimate of their errors.
std::optional<config::Violation> FindClockConflict(const AgentModel& s) {
  constexpr double kMostOffset_s = 1e-3, kMostDrift_ppm = 0.1;
  if (s.localization.by == RangesBy::kPing || s.localization.clocks == Clocks::kEstimated) {
    return {};
  }
  const acoustics::ModemConfig& modem = s.channel.physical.modem;
  if (modem.clock_offset_std_s <= kMostOffset_s && modem.clock_drift_std_ppm <= kMostDrift_ppm) {
    return {};
  }
  return config::Violation{
      {"localization.ranges.clocks", "channel.physical.modem.clock_offset_std_s",
       "channel.physical.modem.clock_drift_std_ppm"},
      "travel times by 'clocks: known' need more exact clocks: set 'clocks: estimated', or 'by: "
      "ping'"};
}

/// Conditions for reported fixes, and for AUVs that surface for them.
std::optional<config::Violation> FindFixConflict(const AgentModel& s) {
  const bool reported = dynamics::ReckonsPosition(s.navigation) && s.navigation.gps_depth_m > 0.0 &&
                        s.navigation.fixes == dynamics::FixUse::kReported;
  if (reported && s.sensing.relative().ambiguous) {
    return config::Violation{{"navigation.dead_reckoning.fixes", "sensing.sensor"},
                             "packets with ambiguous bearings have no room for reported fixes"};
  }
  if (!s.surfaces()) return {};
  if (!reported || !s.sea.open) {
    return config::Violation{
        {"localization.ranges.surface_std_m", "navigation.dead_reckoning.fixes",
         "navigation.dead_reckoning.gps_depth_m", "sea.open"},
        "AUVs that surface for fixes need open water and the navigation 'dead_reckoning' with "
        "'fixes: reported' and a 'gps_depth_m' above 0"};
  }
  if (s.control.interface != dynamics::ActionInterface::kVelocity3) {
    return config::Violation{
        {"localization.ranges.surface_std_m", "control.interface"},
        "an AUV that surfaces for fixes commands its vertical velocity: set 'velocity3'"};
  }
  return {};
}

}  // namespace

std::optional<config::Violation> FindLocalizationConflict(const AgentModel& s) {
  const bool located = s.track.observers == ObserverErrors::kLocated;
  if (!s.locates()) {
    if (s.stations.count() > 0) {
      return config::Violation{{"stations.beacons", "stations.crafts", "localization.kind"},
                               "only a localizer uses stations: set localization.kind"};
    }
    if (dynamics::ReckonsPosition(s.navigation) && s.navigation.gps_depth_m > 0.0 &&
        s.navigation.fixes == dynamics::FixUse::kReported) {
      return config::Violation{{"navigation.dead_reckoning.fixes", "localization.kind"},
                               "only a localizer uses reported fixes: set localization.kind"};
    }
    if (!located) return {};
    return config::Violation{{"track.measurements.observers", "localization.kind"},
                             "'located' needs a localizer: set localization.kind"};
  }
  if (s.track.filter != "measurements" || !located) {
    return config::Violation{
        {"localization.kind", "track.filter", "track.measurements.observers"},
        "a localizer needs the filter 'measurements' with 'observers: located'"};
  }
  const bool corrected =
      s.navigation.gps_depth_m > 0.0 && s.navigation.fixes == dynamics::FixUse::kCorrect;
  if (!dynamics::ReckonsPosition(s.navigation) || corrected) {
    return config::Violation{
        {"localization.kind", "navigation.kind", "navigation.dead_reckoning.gps_depth_m",
         "navigation.dead_reckoning.fixes"},
        "a localizer needs positions that GPS does not correct: 'dead_reckoning' with "
        "'gps_depth_m: 0' or 'fixes: reported'"};
  }
  if (auto violation = FindFixConflict(s)) return violation;
  const auto water =
      acoustics::PropagationModels().Make(s.channel.model, s.channel.models, s.channel);
  if (!water->has_modems()) {
    return config::Violation{{"localization.kind", "channel.model"},
                             "only modems measure travel times: set channel.model to physical"};
  }
  if (auto violation = FindClockConflict(s)) return violation;
  constexpr int kMostMembers = 31, kMostTargets = 16;  // limits of a packet
  if (s.run.agents + s.stations.count() > kMostMembers || s.target.count > kMostTargets) {
    return config::Violation{
        {"localization.kind", "agents", "stations.beacons", "stations.crafts", "target.count"},
        "packets with ranges can name at most 31 AUVs and stations, and 16 targets"};
  }
  return acoustics::FindConflict(s.channel, NetworkRun(s.run, s.stations));
}

double Covariance3::SquaredNorm(const Vec3<double>& e) const {
  const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const double d = xx * zz - xz * xz, f = xy * xz - xx * yz, g = xx * yy - xy * xy;
  const double det = xx * a + xy * b + xz * c;
  if (!(det > 0.0)) return std::numeric_limits<double>::infinity();
  return (e.x * (a * e.x + b * e.y + c * e.z) + e.y * (b * e.x + d * e.y + f * e.z) +
          e.z * (c * e.x + f * e.y + g * e.z)) /
         det;
}

}  // namespace stg::agent

#include <cmath>

#include "looks.hpp"

namespace stg::dynamics {
namespace {

/// Measures range, bearing or both of a target from the true geometry, with normal noise. The
/// standard deviation of the range is a + b r; for azimuth and elevation it is constant. Outliers
/// and false alarms are uniform in range and direction.
class RelativeSensor : public TargetSensor {
 public:
  RelativeSensor(const RelativeOptions& options, const SensingConfig& config, MeasurementKind kind)
      : options_(options),
        config_(config),
        kind_(kind),
        bearing_std_(options.bearing_std_deg * kPi / 180.0),
        cos_half_view_(std::cos(0.5 * options.field_of_view_deg * kPi / 180.0)) {}

  MeasurementKind kind() const override { return kind_; }

  bool Sense(const Look& look, Detection* out) const override {
    // If modems measure ranges, the channel does it.
    if (config_.pings() || !LooksNow(config_, look)) return false;
    Measured m;
    if (!Measure(look, &m) && !FalseAlarm(look, &m)) return false;
    out->kind = kind_;
    SetObserver(look, out);
    Tell(look, m, out);
    return true;
  }

 private:
  /// Azimuth and elevation in true world axes.
  struct Measured {
    double range_m, azimuth_rad, elevation_rad;
  };

  bool Measure(const Look& look, Measured* m) const {
    const Vec3<double> r = look.p_WT() - look.p_WB();
    const double range = Norm(r);
    if (range > config_.range_m || range < 1e-9) return false;
    if (options_.field_of_view_deg < 360.0) {
      const Mat3<Pack>& R = look.vehicle_state.R_WB;
      const double ahead = Lane(R.m[0][0], look.lane) * r.x + Lane(R.m[1][0], look.lane) * r.y +
                           Lane(R.m[2][0], look.lane) * r.z;
      if (ahead < cos_half_view_ * range) return false;
    }
    if (Blind(config_, look)) return false;
    Random random = look.clock.Draw(Stream::kMeasurement, look.pair);
    const double share = range / config_.range_m;
    if (random.Uniform() >= options_.chance(config_.detection_probability, share)) return false;
    if (random.Uniform() < options_.outlier_probability) {
      *m = Anywhere(&random);
      return true;
    }
    m->range_m = std::abs(range + options_.range_std(range) * random.Normal());
    m->azimuth_rad = std::atan2(r.y, r.x) + bearing_std_ * random.Normal();
    m->elevation_rad = std::asin(Clip(r.z / range, -1.0, 1.0)) + bearing_std_ * random.Normal();
    return true;
  }

  bool FalseAlarm(const Look& look, Measured* m) const {
    if (options_.false_alarm_probability <= 0.0) return false;
    Random random = look.clock.Draw(Stream::kFalseAlarm, look.pair);
    if (random.Uniform() >= options_.false_alarm_probability) return false;
    *m = Anywhere(&random);
    return true;
  }

  Measured Anywhere(Random* random) const {
    return {random->Uniform(0.0, config_.range_m), random->Uniform(-kPi, kPi),
            random->Uniform(-0.5 * kPi, 0.5 * kPi)};
  }

  /// Writes the measurement in the frame of the vehicle's own navigation.
  void Tell(const Look& look, const Measured& m, Detection* out) const {
    const bool has_range = kind_ != MeasurementKind::kBearing;
    const bool has_bearing = kind_ != MeasurementKind::kRange;
    out->p_WT = out->p_WO;
    out->std_m = config_.range_m;
    out->range_m = out->range_std_m = 0.0;
    out->azimuth_rad = out->elevation_rad = out->bearing_std_rad = out->mirror_azimuth_rad = 0.0;
    out->ambiguous = false;
    if (has_range) {
      out->range_m = m.range_m;
      out->range_std_m = options_.range_std(m.range_m);
    }
    if (!has_bearing) return;
    out->azimuth_rad = WrapAngle(m.azimuth_rad + look.observer.heading_error_rad);
    out->elevation_rad = m.elevation_rad;
    out->bearing_std_rad = bearing_std_;
    if (options_.ambiguous) TellBothSides(look, out);
    if (!has_range) return;
    const double c = std::cos(out->elevation_rad);
    out->p_WT += Vec3<double>{c * std::cos(out->azimuth_rad), c * std::sin(out->azimuth_rad),
                              std::sin(out->elevation_rad)} *
                 m.range_m;
    out->std_m = Max(out->range_std_m, m.range_m * bearing_std_);
  }

  /// Writes both possible bearings, port first, whichever of them is true.
  static void TellBothSides(const Look& look, Detection* out) {
    const Mat3<Pack>& R = look.vehicle_state.R_WB;
    const double heading = std::atan2(Lane(R.m[1][0], look.lane), Lane(R.m[0][0], look.lane)) +
                           look.observer.heading_error_rad;
    const double off = std::abs(WrapAngle(out->azimuth_rad - heading));
    out->ambiguous = true;
    out->azimuth_rad = WrapAngle(heading + off);
    out->mirror_azimuth_rad = WrapAngle(heading - off);
  }

  RelativeOptions options_;
  SensingConfig config_;
  MeasurementKind kind_;
  double bearing_std_, cos_half_view_;
};

std::unique_ptr<const TargetSensor> MakeRangeSensor(const RelativeOptions& options,
                                                    const SensingConfig& config) {
  return std::make_unique<RelativeSensor>(options, config, MeasurementKind::kRange);
}

std::unique_ptr<const TargetSensor> MakeBearingSensor(const RelativeOptions& options,
                                                      const SensingConfig& config) {
  return std::make_unique<RelativeSensor>(options, config, MeasurementKind::kBearing);
}

std::unique_ptr<const TargetSensor> MakeRangeBearingSensor(const RelativeOptions& options,
                                                           const SensingConfig& config) {
  return std::make_unique<RelativeSensor>(options, config, MeasurementKind::kRangeBearing);
}

}  // namespace

SensorRegistry::Entry RangeSensorEntry() {
  return {"range", MakeRangeSensor, RelativeOptions{true, false}};
}
SensorRegistry::Entry BearingSensorEntry() {
  return {"bearing", MakeBearingSensor, RelativeOptions{false, true}};
}
SensorRegistry::Entry RangeBearingSensorEntry() {
  return {"range_bearing", MakeRangeBearingSensor};
}

}  // namespace stg::dynamics

#include <cmath>

#include "looks.hpp"

namespace stg::dynamics {
namespace {

/// Measures the target's position, within a range, with independent noise on each component. With
/// ideal values it is the paper's sensor.
class PositionSensor : public TargetSensor {
 public:
  explicit PositionSensor(const SensingConfig& config) : config_(config) {}

  MeasurementKind kind() const override { return MeasurementKind::kPosition; }

  bool Sense(const Look& look, Detection* out) const override {
    const Vec3<double> p_WB = look.p_WB(), p_WT = look.p_WT();
    if (Norm(p_WT - p_WB) > config_.range_m || !LooksNow(config_, look)) return false;
    out->kind = MeasurementKind::kPosition;
    SetObserver(look, out);
    out->p_WT = p_WT;
    out->std_m = config_.noise_std_m;
    if (Ideal()) {
      TellOwn(look, out);
      return true;
    }
    if (Blind(config_, look)) return false;
    Random random = look.clock.Draw(Stream::kDetection, look.pair);
    if (random.Uniform() >= config_.detection_probability) return false;
    const double s = config_.noise_std_m;
    out->p_WT += Vec3<double>{s * random.Normal(), s * random.Normal(), s * random.Normal()};
    TellOwn(look, out);
    return true;
  }

 private:
  bool Ideal() const {
    return config_.detection_probability >= 1.0 && config_.noise_std_m == 0.0 &&
           config_.dropout_rate_hz == 0.0;
  }

  /// Turns the measured position into the frame of the vehicle's own navigation.
  static void TellOwn(const Look& look, Detection* out) {
    if (!look.drifts) return;
    const Vec3<double> r = out->p_WT - look.p_WB();
    const double c = std::cos(look.observer.heading_error_rad);
    const double s = std::sin(look.observer.heading_error_rad);
    out->p_WT = look.observer.p_WO + Vec3<double>{c * r.x - s * r.y, s * r.x + c * r.y, r.z};
  }

  SensingConfig config_;
};

std::unique_ptr<const TargetSensor> MakePositionSensor(const SensingConfig& config) {
  return std::make_unique<PositionSensor>(config);
}

}  // namespace

SensorRegistry::Entry PositionSensorEntry() { return {"position", MakePositionSensor}; }

}  // namespace stg::dynamics

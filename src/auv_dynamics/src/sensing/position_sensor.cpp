#include <cmath>

#include "sensors.hpp"

namespace stg::dynamics {
namespace {

/// The target's position with independent noise on each component, within a range. Ideal values
/// are the paper's sensor.
class PositionSensor : public TargetSensor {
 public:
  explicit PositionSensor(const SensingConfig& config) : config_(config) {}

  MeasurementKind kind() const override { return MeasurementKind::kPosition; }

  bool Sense(const Look& look, Detection* out) const override {
    const Vec3<double> p_WB = look.p_WB(), p_WT = look.p_WT();
    if (Norm(p_WT - p_WB) > config_.range_m) return false;
    out->kind = MeasurementKind::kPosition;
    out->stamp = look.stamp;
    out->target = look.target;
    out->p_WT = p_WT;
    out->std_m = config_.noise_std_m;
    if (config_.detection_probability >= 1.0 && config_.noise_std_m == 0.0 &&
        config_.dropout_rate_hz == 0.0) {
      return true;
    }
    if (Blind(look)) return false;
    Random random = look.clock.Draw(Stream::kDetection, look.pair);
    if (random.Uniform() >= config_.detection_probability) return false;
    const double s = config_.noise_std_m;
    out->p_WT += Vec3<double>{s * random.Normal(), s * random.Normal(), s * random.Normal()};
    return true;
  }

 private:
  /// Dropouts start in each spell-long slot with the probability of a Poisson
  /// process of the given rate and blind the sensor for that slot: memoryless
  /// across slots, so that a draw needs no history.
  bool Blind(const Look& look) const {
    if (config_.dropout_rate_hz <= 0.0) return false;
    const auto slot = static_cast<std::uint32_t>(look.time_s / config_.dropout_duration_s);
    Random random = look.clock.DrawAt(Stream::kDetection, slot, look.pair | 0x800000U);
    return random.Uniform() < 1.0 - std::exp(-config_.dropout_rate_hz * config_.dropout_duration_s);
  }

  SensingConfig config_;
};

}  // namespace

std::unique_ptr<const TargetSensor> MakePositionSensor(const SensingConfig& config) {
  return std::make_unique<PositionSensor>(config);
}

}  // namespace stg::dynamics

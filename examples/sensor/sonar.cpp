// A target sensor of your own: a position whose error grows with the distance. See
// docs/how_to/add_a_sensor.md.

#include <cmath>
#include <cstdio>

#include "auv_dynamics/world/world.hpp"

namespace {

using namespace stg;
using namespace stg::dynamics;

class Sonar : public TargetSensor {
 public:
  explicit Sonar(const SensingConfig& config) : config_(config) {}

  MeasurementKind kind() const override { return MeasurementKind::kPosition; }

  bool Sense(const Look& look, Detection* out) const override {
    const Vec3<double> p_WT = look.p_WT();
    const double distance = Norm(p_WT - look.p_WB());
    if (distance > config_.range_m) return false;
    // The draws of this step, vehicle and target: whoever asks, and however often, gets the same.
    Random random = look.clock.Draw(Stream::kDetection, look.pair);
    if (random.Uniform() >= config_.detection_probability) return false;
    const double s = config_.noise_std_m + kShare * distance;
    out->kind = kind();
    out->stamp = look.stamp;
    out->target = look.target;
    out->std_m = s;
    out->p_WT = p_WT + Vec3<double>{s * random.Normal(), s * random.Normal(), s * random.Normal()};
    return true;
  }

 private:
  static constexpr double kShare = 0.01;  // of the distance

  SensingConfig config_;
};

std::unique_ptr<const TargetSensor> MakeSonar(const SensingConfig& config) {
  return std::make_unique<Sonar>(config);
}

}  // namespace

int main() {
  TargetSensors().Add("sonar", MakeSonar);

  WorldScenario config;
  config.run.agents = 1;
  config.world.sensing.sensor = "sonar";
  config.world.sensing.range_m = 500.0;
  config.world.sensing.noise_std_m = 1.0;
  config.world.workspace.half_extent_m = 1000.0;
  World world(config);
  world.Place(0, {{0.0, 0.0, 0.0}}, {{300.0, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});

  // 1 m and 1 % of 300 m: 4 m in each component.
  const std::vector<Wrench<Pack>> nothing(1);
  const int steps = 4000;
  double squares = 0.0;
  for (int k = 0; k < steps; ++k) {
    Detection detection;
    if (!world.Sense(0, 0, 0, &detection)) return 1;
    const Vec3<double> error = detection.p_WT - Vec3<double>{300.0, 0.0, 0.0};
    squares += Dot(error, error);
    world.Step(nothing);
  }
  const double deviation = std::sqrt(squares / (3.0 * steps));
  std::printf("deviation of %d detections at 300 m: %.3f m\n", steps, deviation);
  return std::abs(deviation - 4.0) < 0.13 ? 0 : 1;  // five deviations of the estimate
}

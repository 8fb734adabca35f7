// A target sensor of your own: a position whose error grows with the distance. See
// docs/how_to/add_a_sensor.md.

#include <cmath>
#include <cstdio>

#include "auv_common/config/loader.hpp"
#include "auv_common/plugin.hpp"
#include "auv_dynamics/world/world.hpp"

namespace {

using namespace stg;
using namespace stg::dynamics;

struct SonarOptions {
  double near_std_m = 1.0;  // of each component, close to the vehicle
  double share = 0.01;      // share of the distance that is added
};

void Describe(SonarOptions* o, config::Table* t) {
  t->Add("near_std_m", &o->near_std_m, config::NonNegative(1e4), "m",
         "standard deviation of each component beside the vehicle");
  t->Add("share", &o->share, config::kFraction, "-", "share of the distance that is added to it");
}

class Sonar : public TargetSensor {
 public:
  Sonar(const SonarOptions& options, const SensingConfig& config)
      : options_(options), config_(config) {}

  MeasurementKind kind() const override { return MeasurementKind::kPosition; }

  bool Sense(const Look& look, Detection* out) const override {
    const Vec3<double> p_WT = look.p_WT();
    const double distance = Norm(p_WT - look.p_WB());
    if (distance > config_.range_m) return false;
    // The draws for this step, vehicle and target. Every call in this step gets the same ones.
    Random random = look.clock.Draw(Stream::kDetection, look.pair);
    if (random.Uniform() >= config_.detection_probability) return false;
    const double s = options_.near_std_m + options_.share * distance;
    out->kind = kind();
    out->stamp = look.stamp;
    out->target = look.target;
    out->std_m = s;
    out->p_WT = p_WT + Vec3<double>{s * random.Normal(), s * random.Normal(), s * random.Normal()};
    return true;
  }

 private:
  SonarOptions options_;
  SensingConfig config_;
};

std::unique_ptr<const TargetSensor> MakeSonar(const SonarOptions& options,
                                              const SensingConfig& config) {
  return std::make_unique<Sonar>(options, config);
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { TargetSensors().Add("sonar", MakeSonar); }

int main() {
  stg_plugin_register();

  WorldScenario config;
  config.run.agents = 1;
  config.world.sensing.range_m = 500.0;
  config::Override(&config, {"sensing.sensor=sonar", "sensing.sonar.share=0.02"});
  config.world.workspace.half_extent_m = 1000.0;
  World world(config);
  world.Place(0, {{0.0, 0.0, 0.0}}, {{300.0, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});

  // 1 m and 2 % of 300 m: the standard deviation of each component is 7 m.
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
  return std::abs(deviation - 7.0) < 0.23 ? 0 : 1;  // five standard deviations of the estimate
}

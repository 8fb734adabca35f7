// A target motion of your own: it turns one way for a while, then the other. See
// docs/how_to/add_a_target_motion.md.

#include <cmath>
#include <cstdio>

#include "auv_common/config/loader.hpp"
#include "auv_common/plugin.hpp"
#include "auv_dynamics/targets/steered_motion.hpp"
#include "auv_dynamics/world/world.hpp"

namespace {

using namespace stg;
using namespace stg::dynamics;

struct ZigzagOptions {
  double leg_s = 10.0;
  double rate_radps = 0.1;
};

void Describe(ZigzagOptions* o, config::Table* t) {
  t->Add("leg_s", &o->leg_s, config::Positive(1e5), "s", "time between two changes of side");
  t->Add("rate_radps", &o->rate_radps, config::NonNegative(10), "rad/s", "turn rate");
}

class Zigzag : public SteeredMotion {
 public:
  Zigzag(const ZigzagOptions& options, const MotionSetup& setup)
      : SteeredMotion(setup), options_(options) {}

 private:
  Vec3<double> Steer(const Situation& now) override {
    // A function of the clock needs no counter. So there is nothing to reset, and all lanes and
    // programs agree.
    const double time = dt() * now.clock.step;
    const bool left = std::fmod(time / options_.leg_s, 2.0) < 1.0;
    const Vec3<double> up{0.0, 0.0, left ? 1.0 : -1.0};
    return TurnTowards(now.v_WT, Cross(up, now.v_WT), options_.rate_radps * dt());
  }

  ZigzagOptions options_;
};

std::unique_ptr<TargetMotion> MakeZigzag(const ZigzagOptions& options, const MotionSetup& setup) {
  return std::make_unique<Zigzag>(options, setup);
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { TargetMotions().Add("zigzag", MakeZigzag); }

int main() {
  stg_plugin_register();

  WorldScenario config;
  config.run.agents = 1;
  config::Override(&config, {"target.motion=zigzag", "target.zigzag.leg_s=5"});
  World world(config);
  world.Place(0, {{0.5, 0.0, 0.0}}, {{0.0, 0.0, 0.0}}, {{0.02, 0.0, 0.0}});

  // After one turn to the left and one to the right, the course is the same as before.
  const std::vector<Wrench<Pack>> nothing(1);
  double most = 0.0;
  for (int k = 0; k < 100; ++k) {
    world.Step(nothing);
    const Vec3<double> v = Lane(world.target(0).v_WT, 0);
    most = std::max(most, std::atan2(v.y, v.x));
  }
  const Vec3<double> v = Lane(world.target(0).v_WT, 0);
  const double course = std::atan2(v.y, v.x);
  std::printf("largest course %.3f rad, at the end %.3f rad, speed %.3f m/s\n", most, course,
              Norm(v));
  return std::abs(most - 0.5) < 1e-9 && std::abs(course) < 1e-9 ? 0 : 1;
}

#include <algorithm>

#include "auv_dynamics/targets/steered_motion.hpp"

namespace stg::dynamics {
namespace {

struct EvasiveOptions {
  double range_m = 0.10;
};

void Describe(EvasiveOptions* o, config::Table* t) {
  t->Add("range_m", &o->range_m, config::NonNegative(1e4), "m",
         "the target flees AUVs closer than this");
}

/// Flees from every vehicle in range; closer vehicles have a stronger effect. In open water it
/// keeps its depth. It moves straight on while no vehicle is in range.
class Evasive : public SteeredMotion {
 public:
  Evasive(const EvasiveOptions& options, const MotionSetup& setup)
      : SteeredMotion(setup), options_(options) {}

 private:
  Vec3<double> Steer(const Situation& now) override {
    const double range = options_.range_m;
    Vec3<double> away;
    double closest = range;
    for (const VehicleState<Pack>& vehicle : now.vehicles) {
      Vec3<double> r = now.p_WT - Lane(vehicle.p_WB, now.lane);
      const double d = std::max(Norm(r), 1e-6);
      if (d >= range) continue;
      if (open_water()) r.z = 0.0;
      away += r * (1.0 / (d * d));
      closest = std::min(closest, d);
    }
    return closest < range ? TurnTowards(now.v_WT, away, largest_turn()) : now.v_WT;
  }

  EvasiveOptions options_;
};

std::unique_ptr<TargetMotion> MakeEvasive(const EvasiveOptions& options, const MotionSetup& setup) {
  return std::make_unique<Evasive>(options, setup);
}

}  // namespace

MotionRegistry::Entry EvasiveEntry() { return {"evasive", MakeEvasive}; }

}  // namespace stg::dynamics

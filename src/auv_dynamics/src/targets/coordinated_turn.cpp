#include "auv_dynamics/targets/steered_motion.hpp"

namespace stg::dynamics {
namespace {

struct CoordinatedTurnOptions {
  double rate_radps = 0.1, period_s = 10.0;
};

void Describe(CoordinatedTurnOptions* o, config::Table* t) {
  t->Add("rate_radps", &o->rate_radps, config::NonNegative(10), "rad/s",
         "mean magnitude of the turn rate");
  t->Add("period_s", &o->period_s, config::Positive(1e5), "s", "time between new turn rates");
}

/// Turns about an axis at a rate. Both are drawn anew in every turn period. In open water it turns
/// to port or starboard.
class CoordinatedTurn : public SteeredMotion {
 public:
  CoordinatedTurn(const CoordinatedTurnOptions& options, const MotionSetup& setup)
      : SteeredMotion(setup), options_(options) {}

 private:
  Vec3<double> Steer(const Situation& now) override {
    const double time = dt() * now.clock.step;
    Random random =
        now.clock.DrawAt(Stream::kTarget, static_cast<std::uint32_t>(time / options_.period_s),
                         static_cast<std::uint32_t>(now.target));
    const double rate =
        Clip(2.0 * random.Uniform() * options_.rate_radps, 0.0, config().max_turn_rate_radps);
    const Vec3<double> axis{random.Normal(), random.Normal(), random.Normal()};
    const Vec3<double> upright{0.0, 0.0, axis.z};
    return TurnTowards(now.v_WT, Cross(open_water() ? upright : axis, now.v_WT), rate * dt());
  }

  CoordinatedTurnOptions options_;
};

std::unique_ptr<TargetMotion> MakeCoordinatedTurn(const CoordinatedTurnOptions& options,
                                                  const MotionSetup& setup) {
  return std::make_unique<CoordinatedTurn>(options, setup);
}

}  // namespace

MotionRegistry::Entry CoordinatedTurnEntry() { return {"coordinated_turn", MakeCoordinatedTurn}; }

}  // namespace stg::dynamics

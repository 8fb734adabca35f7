#include "auv_dynamics/targets/steered_motion.hpp"
#include "motions.hpp"

namespace stg::dynamics {
namespace {

/// Turns about an axis at a rate, both drawn anew every turn period; in open water to port or to
/// starboard.
class CoordinatedTurn : public SteeredMotion {
 public:
  using SteeredMotion::SteeredMotion;

 private:
  Vec3<double> Steer(const Situation& now) override {
    const double time = dt() * now.clock.step;
    Random random =
        now.clock.DrawAt(Stream::kTarget, static_cast<std::uint32_t>(time / config().turn_period_s),
                         static_cast<std::uint32_t>(now.target));
    const double rate =
        Clip(2.0 * random.Uniform() * config().turn_rate_radps, 0.0, config().max_turn_rate_radps);
    const Vec3<double> axis{random.Normal(), random.Normal(), random.Normal()};
    const Vec3<double> upright{0.0, 0.0, axis.z};
    return TurnTowards(now.v_WT, Cross(open_water() ? upright : axis, now.v_WT), rate * dt());
  }
};

}  // namespace

std::unique_ptr<TargetMotion> MakeCoordinatedTurn(const MotionSetup& setup) {
  return std::make_unique<CoordinatedTurn>(setup);
}

}  // namespace stg::dynamics

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
      : SteeredMotion(setup),
        options_(options),
        turns_(static_cast<std::size_t>(kLanes * setup.target.count)) {}

  void Reset(int lane) override {
    for (int k = 0; k < config().count; ++k) TurnOf(lane, k).period = -1;
  }

 private:
  struct Turn {
    std::int64_t period = -1;  ///< number of the turn period in which it was drawn; -1: none
    double rate_radps = 0.0;
    Vec3<double> axis;
  };

  Turn& TurnOf(int lane, int target) {
    return turns_[static_cast<std::size_t>(lane * config().count + target)];
  }

  Vec3<double> Steer(const Situation& now) override {
    Turn& turn = TurnOf(now.lane, now.target);
    const auto period = static_cast<std::uint32_t>(dt() * now.clock.step / options_.period_s);
    if (period != turn.period) Draw(now, period, &turn);
    return TurnTowards(now.v_WT, Cross(turn.axis, now.v_WT), turn.rate_radps * dt());
  }

  void Draw(const Situation& now, std::uint32_t period, Turn* turn) const {
    turn->period = period;
    Random random =
        now.clock.DrawAt(Stream::kTarget, period, static_cast<std::uint32_t>(now.target));
    turn->rate_radps =
        Clip(2.0 * random.Uniform() * options_.rate_radps, 0.0, config().max_turn_rate_radps);
    turn->axis = {random.Normal(), random.Normal(), random.Normal()};
    if (open_water()) turn->axis.x = turn->axis.y = 0.0;
  }

  CoordinatedTurnOptions options_;
  std::vector<Turn> turns_;  // [lanes, targets]
};

std::unique_ptr<TargetMotion> MakeCoordinatedTurn(const CoordinatedTurnOptions& options,
                                                  const MotionSetup& setup) {
  return std::make_unique<CoordinatedTurn>(options, setup);
}

}  // namespace

MotionRegistry::Entry CoordinatedTurnEntry() { return {"coordinated_turn", MakeCoordinatedTurn}; }

}  // namespace stg::dynamics

#include <cmath>

#include "auv_dynamics/targets/steered_motion.hpp"

namespace stg::dynamics {
namespace {

/// Where the random numbers of the walk are apart from those of the legs.
constexpr std::uint32_t kWalkIndex = 0x800000U;

struct LegsOptions {
  config::Interval duration_s{60.0, 300.0}, turn_rad{0.5, 1.5};
  double course_walk_rad_per_sqrt_s = 0.0;
};

void Describe(LegsOptions* o, config::Table* t) {
  t->Add("duration_s", &o->duration_s, config::Positive(1e6), "s",
         "[low, high] time between two changes of course");
  t->Add("turn_rad", &o->turn_rad, {0, 3.15}, "rad",
         "[low, high] size of a change of course, to either side");
  t->Add("course_walk_rad_per_sqrt_s", &o->course_walk_rad_per_sqrt_s, config::NonNegative(1),
         "rad/sqrt(s)", "random walk of the course on the way");
}

/// Keeps its course for a while, then changes it by an angle. Both are drawn anew for every leg.
/// On the way the course walks at random. In open water it turns to port or starboard, elsewhere
/// within a plane that is drawn, too.
class Legs : public SteeredMotion {
 public:
  Legs(const LegsOptions& options, const MotionSetup& setup)
      : SteeredMotion(setup),
        options_(options),
        walk_rad_(options.course_walk_rad_per_sqrt_s * std::sqrt(setup.dt_s)),
        legs_(static_cast<std::size_t>(kLanes * setup.target.count)) {}

  void Reset(int lane) override {
    for (int k = 0; k < config().count; ++k) LegOf(lane, k) = Leg{};
  }

 private:
  struct Leg {
    std::uint32_t count = 0;   ///< legs up to now, this one included; 0: none has begun
    double end_s = 0.0;        ///< since the start of the episode
    double to_turn_rad = 0.0;  ///< what is left of its turn; below 0: to the other side
    Vec3<double> axis;
  };

  Leg& LegOf(int lane, int target) {
    return legs_[static_cast<std::size_t>(lane * config().count + target)];
  }

  Vec3<double> Steer(const Situation& now) override {
    Leg& leg = LegOf(now.lane, now.target);
    const double time = dt() * now.clock.step;
    if (leg.count == 0 || time >= leg.end_s) Begin(now, time, &leg);
    const double turn = Clip(leg.to_turn_rad, -largest_turn(), largest_turn());
    leg.to_turn_rad -= turn;
    Random random =
        now.clock.Draw(Stream::kTarget, static_cast<std::uint32_t>(now.target) | kWalkIndex);
    const double angle = Clip(turn + walk_rad_ * random.Normal(), -largest_turn(), largest_turn());
    if (angle == 0.0) return now.v_WT;
    return TurnTowards(now.v_WT, Cross(leg.axis, now.v_WT) * (angle < 0.0 ? -1.0 : 1.0),
                       std::abs(angle));
  }

  void Begin(const Situation& now, double time, Leg* leg) const {
    Random random =
        now.clock.DrawAt(Stream::kTarget, leg->count, static_cast<std::uint32_t>(now.target));
    leg->end_s = time + random.Uniform(options_.duration_s.lo, options_.duration_s.hi);
    const double turn = random.Uniform(options_.turn_rad.lo, options_.turn_rad.hi);
    const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
    const Vec3<double> any{random.Normal(), random.Normal(), random.Normal()};
    leg->axis = open_water() ? Vec3<double>{0.0, 0.0, 1.0} : Cross(now.v_WT, any);
    // The first leg has the course of the start.
    leg->to_turn_rad = leg->count == 0 ? 0.0 : side * turn;
    ++leg->count;
  }

  LegsOptions options_;
  double walk_rad_;        // deviation of the walk of one step
  std::vector<Leg> legs_;  // [lanes, targets]
};

std::unique_ptr<TargetMotion> MakeLegs(const LegsOptions& options, const MotionSetup& setup) {
  return std::make_unique<Legs>(options, setup);
}

}  // namespace

MotionRegistry::Entry LegsEntry() { return {"legs", MakeLegs}; }

}  // namespace stg::dynamics

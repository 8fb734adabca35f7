#include "auv_dynamics/targets/steered_motion.hpp"

namespace stg::dynamics {
namespace {

struct RandomWaypointOptions {
  double radius_m = 0.05;
};

void Describe(RandomWaypointOptions* o, config::Table* t) {
  t->Add("radius_m", &o->radius_m, config::Positive(1e4), "m",
         "distance within which a waypoint counts as reached");
}

/// True if the point `to`, relative to a target with velocity v, lies inside the circle of the
/// tightest turn. A target that turns towards this point would circle it forever.
bool InsideTurningCircle(const Vec3<double>& v, const Vec3<double>& to, double max_turn_rate) {
  const double speed = Norm(v);
  if (speed < 1e-12) return false;
  const double radius = speed / max_turn_rate;
  const double along = Dot(v, to) * (1.0 / speed);
  const double aside = Norm(to - v * (along / speed)) - radius;
  return along * along + aside * aside < radius * radius;
}

/// Moves to random points within 0.8 of the workspace, one after the other. In open water it keeps
/// its depth.
class RandomWaypoint : public SteeredMotion {
 public:
  RandomWaypoint(const RandomWaypointOptions& options, const MotionSetup& setup)
      : SteeredMotion(setup),
        options_(options),
        index_(static_cast<size_t>(setup.target.count) * kLanes, 0) {}

  void Reset(int lane) override {
    for (int k = 0; k < config().count; ++k) index_[Slot(lane, k)] = 0;
  }

 private:
  Vec3<double> Steer(const Situation& now) override {
    std::uint32_t& index = index_[Slot(now.lane, now.target)];
    const auto waypoint = [&] {
      Random random =
          now.clock.DrawAt(Stream::kTarget, index, static_cast<std::uint32_t>(now.target));
      const double e = 0.8 * region();
      const double x = random.Uniform(-e, e), y = random.Uniform(-e, e);
      return Vec3<double>{x, y, open_water() ? now.p_WT.z : random.Uniform(-e, e)};
    };
    const Vec3<double> to = waypoint() - now.p_WT;
    // A point that cannot be reached by a turn is skipped.
    if (Norm(to) < options_.radius_m ||
        InsideTurningCircle(now.v_WT, to, config().max_turn_rate_radps)) {
      ++index;
    }
    return TurnTowards(now.v_WT, waypoint() - now.p_WT, largest_turn());
  }

  size_t Slot(int lane, int target) const {
    return static_cast<size_t>(lane * config().count + target);
  }

  RandomWaypointOptions options_;
  // [lane, target] number of points that were reached or skipped.
  std::vector<std::uint32_t> index_;
};

std::unique_ptr<TargetMotion> MakeRandomWaypoint(const RandomWaypointOptions& options,
                                                 const MotionSetup& setup) {
  return std::make_unique<RandomWaypoint>(options, setup);
}

}  // namespace

MotionRegistry::Entry RandomWaypointEntry() { return {"random_waypoint", MakeRandomWaypoint}; }

}  // namespace stg::dynamics

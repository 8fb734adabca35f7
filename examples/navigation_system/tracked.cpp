// A navigation system of your own: a ship measures the position of the vehicle from time to time
// and sends it. The error of a fix stays until the next fix. See
// docs/how_to/in_this_repository.md.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "auv_common/config/loader.hpp"
#include "auv_common/plugin.hpp"
#include "auv_dynamics/navigation/navigation_system.hpp"
#include "auv_dynamics/world/world.hpp"

namespace {

using namespace stg;
using namespace stg::dynamics;

struct TrackedOptions {
  double std_m = 5.0;     // of each horizontal component of a fix
  double period_s = 1.0;  // between two fixes
};

void Describe(TrackedOptions* o, config::Table* t) {
  t->Add("std_m", &o->std_m, config::NonNegative(1e4), "m, world ENU",
         "standard deviation of each horizontal component of a fix");
  t->Add("period_s", &o->period_s, config::Positive(3600), "s",
         "time between two fixes, rounded to whole physics steps");
}

class Tracked : public NavigationSystem {
 public:
  Tracked(const TrackedOptions& options, const NavigationSetup& setup)
      : std_m_(options.std_m),
        steps_(
            static_cast<std::uint32_t>(std::max(1.0, std::round(options.period_s / setup.dt_s)))),
        states_(static_cast<std::size_t>(setup.vehicles)) {}

  void Reset(int lane, int i, const EpisodeClock& clock,
             const VehicleState<Pack>& vehicle) override {
    At(i).p_WB = vehicle.p_WB;
    Fix(lane, i, clock);
  }

  void Step(int i, const EpisodeClocks& clocks, const VehicleState<Pack>& vehicle,
            const Vec3<Pack>& /*v_WC*/, const Terrain& /*terrain*/) override {
    At(i).p_WB = vehicle.p_WB;
    // Each lane has a clock of its own, because each lane is another episode.
    for (int lane = 0; lane < kLanes; ++lane) {
      const EpisodeClock& clock = clocks[static_cast<std::size_t>(lane)];
      if (clock.step % steps_ == 0) Fix(lane, i, clock);
    }
  }

  void Believe(int i, Navigation<Pack>* navigation) const override {
    navigation->p_WB += states_[static_cast<std::size_t>(i)].error;
    navigation->position_std_m = Pack(std_m_);
  }

  Observer At(int lane, int i) const override {
    const State& s = states_[static_cast<std::size_t>(i)];
    return {Lane(s.p_WB, lane) + Lane(s.error, lane), std_m_};
  }

 private:
  struct State {
    Vec3<Pack> p_WB, error;
  };

  State& At(int i) { return states_[static_cast<std::size_t>(i)]; }

  void Fix(int lane, int i, const EpisodeClock& clock) {
    Random random =
        clock.DrawAt(Stream::kNavigation, clock.step / steps_, static_cast<std::uint32_t>(i));
    const double x = random.Normal(), y = random.Normal();
    SetLane(&At(i).error, lane, Vec3<double>{x, y, 0.0} * std_m_);
  }

  double std_m_;
  std::uint32_t steps_;        // physics steps between two fixes
  std::vector<State> states_;  // [vehicles]
};

std::unique_ptr<NavigationSystem> MakeTracked(const TrackedOptions& options,
                                              const NavigationSetup& setup) {
  return std::make_unique<Tracked>(options, setup);
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { NavigationSystems().Add("tracked", MakeTracked); }

int main() {
  stg_plugin_register();

  WorldScenario config;
  config.run.agents = 1;
  config::Override(&config, {"navigation.kind=tracked", "navigation.tracked.std_m=3"});
  config.world.workspace.half_extent_m = 100.0;
  World world(config);
  world.Place(0, {{0.0, 0.0, -5.0}}, {{20.0, 0.0, -5.0}}, {{0.0, 0.0, 0.0}});

  // The vehicle gets a fix every ten steps. Between two fixes, the error stays.
  const std::vector<Wrench<Pack>> nothing(1);
  const auto error = [&world] { return world.Nav(0, 0).p_WB - world.Truth(0, 0).p_WB; };
  constexpr int kFixes = 4000;
  double squares = 0.0;
  bool stays = true;
  for (int k = 0; k < kFixes; ++k) {
    const Vec3<double> fixed = error();
    squares += Dot(fixed, fixed);
    for (int step = 0; step < 9; ++step) {
      world.Step(nothing);
      stays = stays && Norm(error() - fixed) < 1e-9;
    }
    world.Step(nothing);
  }
  const double deviation = std::sqrt(squares / (2.0 * kFixes));
  std::printf("deviation of %d fixes: %.3f m\n", kFixes, deviation);
  // Five standard deviations of the estimate.
  return stays && std::abs(deviation - 3.0) < 0.17 ? 0 : 1;
}

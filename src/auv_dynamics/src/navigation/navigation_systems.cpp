#include "auv_dynamics/navigation/navigation_system.hpp"

namespace stg::dynamics {
namespace {

/// Every vehicle knows its exact state, as the paper assumes.
class PerfectNavigation : public NavigationSystem {
 public:
  bool perfect() const override { return true; }
  void Reset(int, int, const EpisodeClock&, const VehicleState<Pack>&) override {}
  void Step(int, const EpisodeClocks&, const VehicleState<Pack>&, const Vec3<Pack>&,
            const Terrain&) override {}
  void Believe(int, Navigation<Pack>*) const override {}
  Observer At(int, int) const override { return {}; }
};

}  // namespace

NavigationRegistry& NavigationSystems() {
  static NavigationRegistry registry(
      "navigation system",
      {
          {"perfect", [](const NavigationSetup&) { return std::make_unique<PerfectNavigation>(); }},
          STG_ENTRY(NavigationRegistry, DeadReckoningEntry),
      });
  return registry;
}

bool ReckonsPosition(const NavigationConfig& c) { return c.kind == "dead_reckoning"; }

}  // namespace stg::dynamics

#include "auv_dynamics/autopilot/autopilot.hpp"
#include "kinematic_autopilot.hpp"
#include "torpedo_autopilot.hpp"

namespace stg::dynamics {
namespace {

template <class T>
std::unique_ptr<const Autopilot> MakeAutopilot(const VehicleConfig& vehicle,
                                               const AutopilotConfig& config) {
  return std::make_unique<T>(vehicle, config);
}

}  // namespace

AutopilotRegistry& Autopilots() {
  static AutopilotRegistry registry("autopilot",
                                    {
                                        {"torpedo", MakeAutopilot<TorpedoAutopilot>},
                                        {"kinematic", MakeAutopilot<KinematicAutopilot>},
                                    });
  return registry;
}

}  // namespace stg::dynamics

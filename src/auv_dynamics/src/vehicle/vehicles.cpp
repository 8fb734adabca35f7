#include "auv_dynamics/vehicle/fully_actuated.hpp"
#include "auv_dynamics/vehicle/shaft_power.hpp"
#include "auv_dynamics/vehicle/torpedo.hpp"
#include "kinematic.hpp"

namespace stg::dynamics {
namespace {

template <class T>
std::unique_ptr<const Vehicle> Make(const VehicleConfig& config) {
  return std::make_unique<T>(config);
}

}  // namespace

Space VelocityActions(const VehicleConfig& config) {
  const char* const axes[] = {"v_x", "v_y", "v_z"};
  Space space;
  for (size_t k = 0; k < config.max_velocity_mps.size(); ++k) {
    const double most = config.max_velocity_mps[k];
    space.push_back({axes[k], "m/s", -most, most});
  }
  return space;
}

bool TurnsPropeller(const VehicleConfig& config, int i) { return config.model_of(i) == "torpedo"; }

VehicleRegistry& Vehicles() {
  static VehicleRegistry registry("vehicle", {
                                                 {"fully_actuated", Make<FullyActuated>},
                                                 {"torpedo", Make<Torpedo>},
                                                 {"kinematic", Make<Kinematic>},
                                             });
  return registry;
}

}  // namespace stg::dynamics

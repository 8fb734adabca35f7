#include "auv_dynamics/vehicle/fully_actuated.hpp"

namespace stg::dynamics {
namespace {

template <class T>
std::unique_ptr<const Vehicle> Make(const VehicleConfig& config) {
  return std::make_unique<T>(config);
}

}  // namespace

VehicleRegistry& Vehicles() {
  static VehicleRegistry registry("vehicle", {
                                                 {"fully_actuated", Make<FullyActuated>},
                                             });
  return registry;
}

}  // namespace stg::dynamics

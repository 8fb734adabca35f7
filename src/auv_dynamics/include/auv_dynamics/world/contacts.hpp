#pragma once

#include <vector>

#include "auv_dynamics/vehicle/vehicle_state.hpp"
#include "auv_dynamics/world/separations.hpp"
#include "auv_dynamics/world/surroundings_config.hpp"

namespace stg::dynamics {

/// Forces between vehicles in contact: along the line of centres, a softplus of the overlap.
class Contacts {
 public:
  /// @param radius_m collision radius of one vehicle
  Contacts(const ContactConfig& config, int vehicles, double radius_m);

  /// Forces in this state; `separations` must have been measured in it.
  void Update(const std::vector<VehicleState<Pack>>& vehicles,
              const Separations<Pack>& separations);
  /// On vehicle i, world axes [N].
  const Vec3<Pack>& force(int i) const { return forces_[static_cast<size_t>(i)]; }

 private:
  ContactConfig config_;
  double radius_m_;
  std::vector<Vec3<Pack>> forces_;
};

}  // namespace stg::dynamics

#pragma once

#include <memory>
#include <vector>

#include "auv_dynamics/vehicle/vehicle.hpp"

namespace stg::dynamics {

/// The vehicles of a world, which may be of several kinds (`vehicle.models`). Commands and internal
/// states of all of them stand in rows of one length, that of the kind that needs most.
class VehicleSet {
 public:
  /// @param vehicles how many there are
  VehicleSet(const VehicleConfig& config, int vehicles);

  const Vehicle& operator[](int i) const { return *of_[static_cast<std::size_t>(i)]; }
  /// Numbers of a row of commands, of which a vehicle takes as many as it has actuators.
  std::size_t command_size() const { return command_size_; }
  /// The same of a row of internal states.
  std::size_t internal_size() const { return internal_size_; }

 private:
  std::vector<std::unique_ptr<const Vehicle>> kinds_;
  std::vector<const Vehicle*> of_;  // [vehicles]
  std::size_t command_size_ = 0, internal_size_ = 0;
};

}  // namespace stg::dynamics

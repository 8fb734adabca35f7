#pragma once

#include <memory>
#include <vector>

#include "auv_dynamics/vehicle/vehicle.hpp"

namespace stg::dynamics {

/// The vehicles of a world, which may be of several kinds (`vehicle.models`). Their commands and
/// internal states are in rows of equal length: the length that the largest kind needs.
class VehicleSet {
 public:
  /// @param vehicles number of vehicles
  VehicleSet(const VehicleConfig& config, int vehicles);

  const Vehicle& operator[](int i) const { return *of_[static_cast<std::size_t>(i)]; }
  /// Length of a row of commands; a vehicle uses as many numbers as it has actuators.
  std::size_t command_size() const { return command_size_; }
  /// Length of a row of internal states.
  std::size_t internal_size() const { return internal_size_; }

 private:
  std::vector<std::unique_ptr<const Vehicle>> kinds_;
  std::vector<const Vehicle*> of_;  // [vehicles]
  std::size_t command_size_ = 0, internal_size_ = 0;
};

}  // namespace stg::dynamics

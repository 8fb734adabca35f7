#pragma once

#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/vehicle/vehicle.hpp"
#include "auv_dynamics/vehicle/vehicle_model.hpp"

namespace stg::dynamics {

/// A hull with a directly commanded generalised force: the paper's vehicle, Eqs. 2 and 3. Any force
/// within the limits acts at once.
class FullyActuated : public Vehicle {
 public:
  /// Throws UserError when the mass matrix is not positive definite.
  explicit FullyActuated(const VehicleConfig& config);

  const Space& actuators() const override { return actuators_; }
  const Space& actions() const override { return actions_; }
  void Step(const Pack* command, const Surroundings& around, double dt, VehicleState<Pack>* state,
            Pack* internal) const override;
  void Orientation(const VehicleState<Pack>& state, Pack (*q_WB)[4]) const override;

 private:
  VehicleModel model_;
  Space actuators_, actions_;
};

}  // namespace stg::dynamics

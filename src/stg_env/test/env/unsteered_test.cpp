// A vehicle that is registered without an autopilot.

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "auv_common/error.hpp"
#include "auv_dynamics/autopilot/autopilot.hpp"
#include "auv_dynamics/vehicle/vehicle.hpp"
#include "env/env_fixture.hpp"

namespace stg::env {
namespace {

using dynamics::Space, dynamics::Vehicle, dynamics::VehicleConfig;

/// Takes one force.
class Cart : public Vehicle {
 public:
  const Space& actuators() const override { return push_; }
  const Space& actions() const override { return none_; }
  int internal_size() const override { return 0; }
  void Step(const Pack*, const dynamics::Surroundings&, double, dynamics::VehicleState<Pack>*,
            Pack*) const override {}

 private:
  Space push_{{"push", "N", -1.0, 1.0}}, none_;
};

TEST(UnsteeredVehicle, IsRefusedByTheKeyThatChoosesItUntilItHasAnAutopilot) {
  dynamics::Vehicles().Add("cart",
                           [](const VehicleConfig&) { return std::make_unique<const Cart>(); });
  try {
    Shipped("medium", "nominal", {"vehicle.model=cart"});
    FAIL() << "accepted";
  } catch (const UserError& error) {
    const std::string text = error.what();
    for (const char* part : {"vehicle.model=cart", "no autopilot is registered for 'cart'",
                             "torpedo | kinematic", "register an autopilot 'cart'"}) {
      EXPECT_NE(text.find(part), std::string::npos) << text;
    }
  }
  dynamics::Autopilots().Add("cart", [](const VehicleConfig& v, const auto& config) {
    return dynamics::Autopilots().Make("kinematic", v, config);
  });
  EXPECT_NO_THROW(Shipped("medium", "nominal", {"vehicle.model=cart"}));
}

}  // namespace
}  // namespace stg::env

#pragma once

#include "auv_common/config/field.hpp"
#include "auv_dynamics/autopilot/autopilot_config.hpp"

namespace stg::dynamics {

/// Command of a policy: velocity per world axis, or force and torque per body axis.
enum class ActionInterface { kVelocity3, kTau6 };

/// Size of an action, and the largest size of any interface.
constexpr int ActionSize(ActionInterface interface) {
  return interface == ActionInterface::kVelocity3 ? 3 : 6;
}
inline constexpr int kMaxActionSize = 6;

/// Desired yaw: none, or along the desired velocity.
enum class HeadingMode { kFree, kAlongVelocity };

/// From a policy's action to force and torque, Eqs. 23-27.
struct ControlConfig {
  ActionInterface interface = ActionInterface::kVelocity3;
  double action_scale = 0.75;   ///< of the policy mean
  double max_delta = 0.35;      ///< rate limit per decision; 0: none
  double smoothing = 0.20;      ///< alpha of Eq. 27; 0: none
  double velocity_gain = 1.0;   ///< K_v = gain * tau_max / v_max (Eq. 24)
  double attitude_gain = 0.12;  ///< K_eta (Eq. 25), of the maximum moment per rad
  double rate_gain = 0.10;      ///< K_omega (Eq. 25), of the maximum moment per max rate
  HeadingMode heading = HeadingMode::kFree;
  double heading_gain = 0.12;  ///< along_velocity: of the maximum moment per rad
  AutopilotConfig autopilot;   ///< for vehicles that do not take force and moment

  int action_size() const { return ActionSize(interface); }
};

/// Keys, units and ranges of the section.
void Describe(ControlConfig* c, config::Table* t);

}  // namespace stg::dynamics

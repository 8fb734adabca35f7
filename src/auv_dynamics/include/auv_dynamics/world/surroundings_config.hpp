#pragma once

#include <array>

#include "auv_common/config/field.hpp"

namespace stg::dynamics {

/// Water current; the hull forces of Eq. 3 act on the velocity relative to it.
struct CurrentConfig {
  std::array<double, 3> velocity_mps{0.0, 0.0, 0.0};  ///< world frame, irrotational
};

/// First-order Gauss-Markov disturbance w of Eq. 3, body axes.
struct DisturbanceConfig {
  double force_std_n = 0.0;
  double moment_std_nm = 0.0;
  double correlation_time_s = 2.0;
};

/// Repulsion between vehicles: stiffness * softness * softplus((2 radius - distance) / softness).
struct ContactConfig {
  double stiffness = 100.0;  ///< [N per m of softplus argument]
  double softness_m = 0.001;
};

/// The box and what is left of a velocity that meets a wall: its normal and tangential world
/// components, and the body velocity and rates of the vehicle.
struct WorkspaceConfig {
  double half_extent_m = 1.0;  ///< walls at +-half_extent on each axis
  double restitution = 0.2;
  double tangential = 0.85;
  double body_velocity = 0.7;
  double body_rate = 0.8;
};

/// Keys, units and ranges of the sections.
void Describe(CurrentConfig* c, config::Table* t);
void Describe(DisturbanceConfig* c, config::Table* t);
void Describe(ContactConfig* c, config::Table* t);
void Describe(WorkspaceConfig* c, config::Table* t);

}  // namespace stg::dynamics

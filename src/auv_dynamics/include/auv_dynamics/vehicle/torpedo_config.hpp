#pragma once

#include <array>

#include "auv_common/config/field.hpp"

namespace stg::dynamics {

/// Constants of a torpedo-shaped vehicle: a prolate spheroid, neutrally buoyant, with a propeller,
/// a rudder and a stern plane at its tail. The defaults are the REMUS 100 in T. I. Fossen's Python
/// Vehicle Simulator (remus100.py). Its drag and propeller are from Allen, Vorus and Prestero,
/// OCEANS 2000; the lift of a fin and the time constants are Fossen's estimates.
struct TorpedoConfig {
  double length_m = 1.6;     ///< L; the semi-axes are L / 2 and D / 2
  double diameter_m = 0.19;  ///< D
  double water_density_kgpm3 = 1026.0;
  double cg_below_m = 0.02;        ///< centre of gravity below the centre of buoyancy, body origin
  double drag_coefficient = 0.42;  ///< C_d on the frontal area
  double surge_time_s = 20.0;      ///< T_1: linear damping M11 / T_1 at rest
  double sway_time_s = 20.0;       ///< T_2
  double heave_time_s = 20.0;      ///< T_3
  double yaw_time_s = 1.0;         ///< T_6
  double roll_damping = 0.3;       ///< relative damping of roll
  double pitch_damping = 0.8;      ///< relative damping of pitch
  double fin_area_m2 = 0.0133;     ///< of the two rudders together, and of the two stern planes
  double rudder_lift = 0.5;        ///< lift slope [1/rad]
  double stern_plane_lift = 0.7;   ///< lift slope [1/rad]
  double max_fin_rad = 0.2617993877991494;  ///< 15 deg
  double fin_lag_s = 0.1;
  double propeller_diameter_m = 0.14;
  double max_propeller_rpm = 1525.0;
  double propeller_lag_s = 1.0;
  /// K_T and K_Q, each at advance number 0 and at propeller_advance, linear in between and beyond.
  std::array<double, 2> thrust_coefficient{0.4566, 0.1798};
  std::array<double, 2> torque_coefficient{0.07, 0.0312};
  double propeller_advance = 0.6632;
  double propeller_inflow = 0.944;  ///< advance speed as a share of the speed through the water
  double thrust_deduction = 0.1;
  double torque_share = 0.1;  ///< share of the propeller's torque that acts on the hull
  /// The advance speed is computed from the speed over ground, an error of the public model.
  bool advance_over_ground = false;
};

/// Keys, units and ranges of the section `vehicle.torpedo`, which a file may leave out.
void Describe(TorpedoConfig* c, config::Table* t);

}  // namespace stg::dynamics

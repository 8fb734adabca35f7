#include "auv_dynamics/vehicle/torpedo_config.hpp"

#include "auv_dynamics/vehicle/kinematic_config.hpp"

namespace stg::dynamics {

using config::kFraction;
using config::kNone;
using config::NonNegative;
using config::Numbers;
using config::Positive;
using config::Within;

void Describe(TorpedoConfig* c, config::Table* t) {
  t->Section("vehicle.torpedo");
  t->AddOptional("length_m", &c->length_m, "1.6", Positive(100), "m",
                 "torpedo: length L of the hull, a spheroid");
  t->AddOptional("diameter_m", &c->diameter_m, "0.19", Positive(20), "m",
                 "torpedo: diameter D, shorter than the hull");
  t->AddOptional("water_density_kgpm3", &c->water_density_kgpm3, "1026.0", Positive(2000), "kg/m^3",
                 "torpedo: density of the water; the vehicle weighs what it displaces");
  t->AddOptional("cg_below_m", &c->cg_below_m, "0.02", Positive(10), "m",
                 "torpedo: centre of gravity below the centre of buoyancy");
  t->AddOptional("drag_coefficient", &c->drag_coefficient, "0.42", NonNegative(100), "-",
                 "torpedo: C_d on the frontal area");
  t->AddOptional("surge_time_s", &c->surge_time_s, "20.0", Positive(1e6), "s",
                 "torpedo: time constant of linear damping at rest, surge");
  t->AddOptional("sway_time_s", &c->sway_time_s, "20.0", Positive(1e6), "s",
                 "torpedo: time constant of linear damping at rest, sway");
  t->AddOptional("heave_time_s", &c->heave_time_s, "20.0", Positive(1e6), "s",
                 "torpedo: time constant of linear damping, heave");
  t->AddOptional("yaw_time_s", &c->yaw_time_s, "1.0", Positive(1e6), "s",
                 "torpedo: time constant of linear damping, yaw");
  t->AddOptional("roll_damping", &c->roll_damping, "0.3", NonNegative(100), "-",
                 "torpedo: relative damping of roll");
  t->AddOptional("pitch_damping", &c->pitch_damping, "0.8", NonNegative(100), "-",
                 "torpedo: relative damping of pitch");
  t->AddOptional("fin_area_m2", &c->fin_area_m2, "0.0133", NonNegative(100), "m^2",
                 "torpedo: area of both rudders together, and of both stern planes");
  t->AddOptional("rudder_lift", &c->rudder_lift, "0.5", NonNegative(100), "1/rad",
                 "torpedo: lift slope of the rudder");
  t->AddOptional("stern_plane_lift", &c->stern_plane_lift, "0.7", NonNegative(100), "1/rad",
                 "torpedo: lift slope of the stern plane");
  t->AddOptional("max_fin_rad", &c->max_fin_rad, "0.2617993877991494", Positive(1.5), "rad",
                 "torpedo: largest angle of rudder and stern plane");
  t->AddOptional("fin_lag_s", &c->fin_lag_s, "0.1", Positive(1e3), "s",
                 "torpedo: time constant of rudder and stern plane");
  t->AddOptional("propeller_diameter_m", &c->propeller_diameter_m, "0.14", Positive(20), "m",
                 "torpedo: diameter of the propeller");
  t->AddOptional("max_propeller_rpm", &c->max_propeller_rpm, "1525.0", Positive(1e5), "rpm",
                 "torpedo: largest shaft speed, ahead and astern");
  t->AddOptional("propeller_lag_s", &c->propeller_lag_s, "1.0", Positive(1e3), "s",
                 "torpedo: time constant of the shaft speed");
  t->AddOptional("thrust_coefficient", Numbers(&c->thrust_coefficient), "[0.4566, 0.1798]",
                 Within(-10, 10), "-", "torpedo: K_T at advance number 0 and at propeller_advance");
  t->AddOptional("torque_coefficient", Numbers(&c->torque_coefficient), "[0.07, 0.0312]",
                 Within(-10, 10), "-", "torpedo: K_Q at advance number 0 and at propeller_advance");
  t->AddOptional("propeller_advance", &c->propeller_advance, "0.6632", Positive(10), "-",
                 "torpedo: advance number of the second coefficients");
  t->AddOptional("propeller_inflow", &c->propeller_inflow, "0.944", kFraction, "-",
                 "torpedo: advance speed as a share of the speed through the water");
  t->AddOptional("thrust_deduction", &c->thrust_deduction, "0.1", kFraction, "-",
                 "torpedo: share of the thrust that the hull takes back");
  t->AddOptional("torque_share", &c->torque_share, "0.1", kFraction, "-",
                 "torpedo: share of the propeller's torque that rolls the hull");
  t->AddOptional("advance_over_ground", &c->advance_over_ground, "false", kNone, "-",
                 "torpedo: advance speed from the speed over ground, as the public model has it");
}

void Describe(KinematicConfig* c, config::Table* t) {
  t->Section("vehicle.kinematic");
  t->AddOptional("min_speed_mps", &c->min_speed_mps, "0.0", NonNegative(100), "m/s",
                 "kinematic: it cannot be slower; 0: it can stop");
  t->AddOptional("speed_lag_s", &c->speed_lag_s, "2.0", Positive(1e3), "s",
                 "kinematic: time constant of the speed");
  t->AddOptional("turn_lag_s", &c->turn_lag_s, "1.0", Positive(1e3), "s",
                 "kinematic: time constant of the turn rate");
  t->AddOptional("climb_lag_s", &c->climb_lag_s, "2.0", Positive(1e3), "s",
                 "kinematic: time constant of the climb rate");
}

}  // namespace stg::dynamics

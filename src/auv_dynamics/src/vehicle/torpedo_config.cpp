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
  t->Add("length_m", &c->length_m, Positive(100), "m", "length L of the hull, a spheroid");
  t->Add("diameter_m", &c->diameter_m, Positive(20), "m", "diameter D, shorter than the hull");
  t->Add("water_density_kgpm3", &c->water_density_kgpm3, Positive(2000), "kg/m^3",
         "density of the water; the vehicle is neutrally buoyant");
  t->Add("cg_below_m", &c->cg_below_m, Positive(10), "m",
         "centre of gravity below the centre of buoyancy");
  t->Add("drag_coefficient", &c->drag_coefficient, NonNegative(100), "-",
         "drag coefficient C_d of the frontal area");
  t->Add("surge_time_s", &c->surge_time_s, Positive(1e6), "s",
         "time constant of linear damping at rest, surge");
  t->Add("sway_time_s", &c->sway_time_s, Positive(1e6), "s",
         "time constant of linear damping at rest, sway");
  t->Add("heave_time_s", &c->heave_time_s, Positive(1e6), "s",
         "time constant of linear damping, heave");
  t->Add("yaw_time_s", &c->yaw_time_s, Positive(1e6), "s", "time constant of linear damping, yaw");
  t->Add("roll_damping", &c->roll_damping, NonNegative(100), "-", "relative damping of roll");
  t->Add("pitch_damping", &c->pitch_damping, NonNegative(100), "-", "relative damping of pitch");
  t->Add("fin_area_m2", &c->fin_area_m2, NonNegative(100), "m^2",
         "area of both rudders together, and of both stern planes");
  t->Add("rudder_lift", &c->rudder_lift, NonNegative(100), "1/rad", "lift slope of the rudder");
  t->Add("stern_plane_lift", &c->stern_plane_lift, NonNegative(100), "1/rad",
         "lift slope of the stern plane");
  t->Add("max_fin_rad", &c->max_fin_rad, Positive(1.5), "rad",
         "largest angle of rudder and stern plane");
  t->Add("fin_lag_s", &c->fin_lag_s, Positive(1e3), "s", "time constant of rudder and stern plane");
  t->Add("propeller_diameter_m", &c->propeller_diameter_m, Positive(20), "m",
         "diameter of the propeller");
  t->Add("max_propeller_rpm", &c->max_propeller_rpm, Positive(1e5), "rpm",
         "largest shaft speed, ahead and astern");
  t->Add("propeller_lag_s", &c->propeller_lag_s, Positive(1e3), "s",
         "time constant of the shaft speed");
  t->Add("thrust_coefficient", Numbers(&c->thrust_coefficient), Within(-10, 10), "-",
         "K_T at advance number 0 and at propeller_advance");
  t->Add("torque_coefficient", Numbers(&c->torque_coefficient), Within(-10, 10), "-",
         "K_Q at advance number 0 and at propeller_advance");
  t->Add("propeller_advance", &c->propeller_advance, Positive(10), "-",
         "advance number of the second coefficients");
  t->Add("propeller_inflow", &c->propeller_inflow, kFraction, "-",
         "advance speed as a share of the speed through the water");
  t->Add("thrust_deduction", &c->thrust_deduction, kFraction, "-",
         "share of the thrust that is lost because the propeller raises the hull's drag");
  t->Add("torque_share", &c->torque_share, kFraction, "-",
         "share of the propeller's torque that acts on the hull");
  t->Add("advance_over_ground", &c->advance_over_ground, kNone, "-",
         "the advance speed is computed from the speed over ground, as in the public model");
}

void Describe(KinematicConfig* c, config::Table* t) {
  t->Add("min_speed_mps", &c->min_speed_mps, NonNegative(100), "m/s",
         "smallest speed; 0: the vehicle can stop");
  t->Add("speed_lag_s", &c->speed_lag_s, Positive(1e3), "s", "time constant of the speed");
  t->Add("turn_lag_s", &c->turn_lag_s, Positive(1e3), "s", "time constant of the turn rate");
  t->Add("climb_lag_s", &c->climb_lag_s, Positive(1e3), "s", "time constant of the climb rate");
}

}  // namespace stg::dynamics

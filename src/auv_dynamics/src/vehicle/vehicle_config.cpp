#include "auv_dynamics/vehicle/vehicle_config.hpp"

namespace stg::dynamics {

using config::Enum;
using config::kFraction;
using config::kNone;
using config::NonNegative;
using config::Numbers;
using config::Positive;
using config::Within;

void Describe(VehicleConfig* c, config::Table* t) {
  const std::string axes = "surge sway heave roll pitch yaw";
  t->Section("vehicle");
  t->Add("profile", &c->profile, kNone, "-", "label of this set of vehicle constants");
  t->Add("mass_kg", &c->mass_kg, Positive(1e6), "kg", "mass m");
  t->Add("inertia_kgm2", Numbers(&c->inertia_kgm2), Positive(1e8), "kg m^2, body",
         "moments of inertia Ix Iy Iz");
  t->Add("added_mass", Numbers(&c->added_mass), Within(-1e8, 0.0), "kg, kg m^2, body",
         "added-mass derivatives in Fossen's sign, " + axes);
  t->Add("linear_damping", Numbers(&c->linear_damping), NonNegative(1e6), "N s/m, N m s/rad, body",
         "linear damping magnitudes, " + axes);
  t->Add("quadratic_damping", Numbers(&c->quadratic_damping), NonNegative(1e6),
         "N s^2/m^2, N m s^2/rad^2, body", "quadratic damping magnitudes, " + axes);
  t->Add("r_BG_m", Numbers(&c->r_BG_m), Within(-100, 100), "m, body FLU",
         "centre of gravity from the body origin");
  t->Add("r_BB_m", Numbers(&c->r_BB_m), Within(-100, 100), "m, body FLU",
         "centre of buoyancy from the body origin");
  t->Add("weight_n", &c->weight_n, NonNegative(1e7), "N", "weight W");
  t->Add("buoyancy_n", &c->buoyancy_n, NonNegative(1e7), "N", "buoyancy B");
  t->Add("added_mass_coriolis", Enum(&c->added_mass_coriolis, {"full", "no_munk", "off"}), kNone,
         "-", "added-mass part of C(nu): whole, without the Munk moment, or none");
  t->Add("reversed_coriolis", &c->reversed_coriolis, kNone, "-",
         "C(nu) nu enters with the wrong sign, an error of the release that its traces hold");
  t->Add("restoring", &c->restoring, kNone, "-", "weight, buoyancy and righting moment act");
  t->Add("max_velocity_mps", Numbers(&c->max_velocity_mps), Positive(100), "m/s, body",
         "largest u v w; scales actions and observations");
  t->Add("max_rate_radps", Numbers(&c->max_rate_radps), Positive(100), "rad/s, body",
         "largest p q r; scales the controller and observations");
  t->Add("clip_velocity", &c->clip_velocity, kNone, "-",
         "clip body velocity and rates to these limits after every step");
  t->Add("max_tau", Numbers(&c->max_tau), Positive(1e6), "N, N m, body",
         "actuator limits, " + axes);
  t->Add("float32_tau", &c->float32_tau, kNone, "-",
         "round the commanded force and torque to float32, as the release does");
  t->Add("integrator", Enum(&c->integrator, {"semi_implicit", "rk4"}), kNone, "-",
         "time integration: the release's step, or Runge-Kutta of order 4");
  t->Add("substeps", &c->substeps, Within(1, 1000), "-", "integrator steps per physics step");
  t->Add("radius_m", &c->radius_m, Positive(100), "m", "collision radius of one AUV");
}

}  // namespace stg::dynamics

#include "auv_dynamics/vehicle/vehicle_config.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <utility>

#include "auv_common/names.hpp"
#include "auv_dynamics/vehicle/vehicle.hpp"

namespace stg::dynamics {
namespace {

/// Checks Fossen's M = M_RB + M_A about the body origin.
bool MassMatrixIsPositive(const VehicleConfig& v) {
  Eigen::Matrix<double, 6, 6> m = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    m(i, i) = v.mass_kg - v.added_mass[k];
    m(i + 3, i + 3) = v.inertia_kgm2[k] - v.added_mass[k + 3];
  }
  const auto [x, y, z] = v.r_BG_m;
  Eigen::Matrix3d s;
  s << 0.0, -z, y, z, 0.0, -x, -y, x, 0.0;
  m.topRightCorner<3, 3>() = -v.mass_kg * s;
  m.bottomLeftCorner<3, 3>() = v.mass_kg * s;
  return m.llt().info() == Eigen::Success;
}

}  // namespace

using config::Enum;
using config::kNone;
using config::NonNegative;
using config::Numbers;
using config::Positive;
using config::Within;

namespace {

void DescribeFullyActuated(VehicleConfig* c, config::Table* t) {
  const std::string axes = "surge sway heave roll pitch yaw";
  t->Add("mass_kg", &c->mass_kg, config::Positive(1e6), "kg", "mass m");
  t->Add("inertia_kgm2", config::Numbers(&c->inertia_kgm2), config::Positive(1e8), "kg m^2, body",
         "moments of inertia Ix Iy Iz");
  t->Add("added_mass", config::Numbers(&c->added_mass), config::Within(-1e8, 0.0),
         "kg, kg m^2, body", "added-mass derivatives in Fossen's sign, " + axes);
  t->Add("linear_damping", config::Numbers(&c->linear_damping), config::NonNegative(1e6),
         "N s/m, N m s/rad, body", "linear damping magnitudes, " + axes);
  t->Add("quadratic_damping", config::Numbers(&c->quadratic_damping), config::NonNegative(1e6),
         "N s^2/m^2, N m s^2/rad^2, body", "quadratic damping magnitudes, " + axes);
  t->Add("r_BG_m", config::Numbers(&c->r_BG_m), config::Within(-100, 100), "m, body FLU",
         "centre of gravity from the body origin");
  t->Add("r_BB_m", config::Numbers(&c->r_BB_m), config::Within(-100, 100), "m, body FLU",
         "centre of buoyancy from the body origin");
  t->Add("weight_n", &c->weight_n, config::NonNegative(1e7), "N", "weight W");
  t->Add("buoyancy_n", &c->buoyancy_n, config::NonNegative(1e7), "N", "buoyancy B");
  t->Add("added_mass_coriolis", config::Enum(&c->added_mass_coriolis, {"full", "no_munk", "off"}),
         config::kNone, "-", "added-mass part of C(nu): whole, without the Munk moment, or none");
  t->Add("reversed_coriolis", &c->reversed_coriolis, config::kNone, "-",
         "C(nu) nu has the wrong sign, an error of the release that its traces contain");
  t->Add("restoring", &c->restoring, config::kNone, "-",
         "weight, buoyancy and righting moment act");
  t->Add("float32_tau", &c->float32_tau, config::kNone, "-",
         "round the commanded force and torque to float32, as the release does");
}

}  // namespace

std::vector<std::string> IntegratorNames() { return {"semi_implicit", "rk4"}; }

config::Owner VehicleOwner(const VehicleConfig* c, std::vector<std::string> models) {
  const auto chosen = [c] {
    return c->models.empty() ? std::vector<std::string>{c->model} : c->models;
  };
  return {"vehicle", std::move(models), "vehicle.model", chosen, {"vehicle.models"}};
}

bool LimitsRates(const VehicleConfig& c) {
  return VehicleOwner(&c, Without(Vehicles().Names(), {"torpedo"})).IsChosen();
}

void Describe(VehicleConfig* c, config::Table* t) {
  const std::string axes = "surge sway heave roll pitch yaw";
  t->Section("vehicle");
  t->Add("model", config::Name(&c->model, Vehicles().Names()), config::kNone, "-",
         "vehicle model: equations, actuators and action space of an AUV");
  t->AddOptional("models", config::NamesRef{&c->models, Vehicles().Names()}, "[]", kNone, "-",
                 "vehicle models of a mixed fleet, which the AUVs take in turn: AUV i has entry i "
                 "modulo their number; empty: every AUV has `model`");
  t->Add("profile", &c->profile, config::kNone, "-", "label of this set of vehicle constants");
  t->Add("max_velocity_mps", config::Numbers(&c->max_velocity_mps), config::Positive(100),
         "m/s, body", "largest u v w; scales actions and observations");
  t->Add("max_rate_radps", config::Numbers(&c->max_rate_radps), config::Positive(100),
         "rad/s, body", "largest p q r; scales the controller and observations");
  t->Add("clip_velocity", &c->clip_velocity, config::kNone, "-",
         "clip body velocity and rates to these limits after every step");
  t->Add("max_tau", config::Numbers(&c->max_tau), config::Positive(1e6), "N, N m, body",
         "actuator limits, " + axes);
  t->Add("integrator", config::Enum(&c->integrator, IntegratorNames()), config::kNone, "-",
         "time integration: the release's step, or Runge-Kutta of order 4");
  t->Add("substeps", &c->substeps, config::Within(1, 1000), "-",
         "integrator steps per physics step");
  t->Add("radius_m", &c->radius_m, config::Positive(100), "m", "collision radius of one AUV");
  const std::vector<std::string> models = Vehicles().Names();
  for (const char* key : {"integrator", "substeps"}) {
    t->Own(std::string("vehicle.") + key, VehicleOwner(c, Without(models, {"kinematic"})));
  }
  for (const char* key : {"clip_velocity", "max_tau"}) {
    t->Own(std::string("vehicle.") + key,
           VehicleOwner(c, Without(models, {"torpedo", "kinematic"})));
  }
  t->Own("vehicle.model", {"fleet", {"of one model"}, "vehicle.models", [c] {
                             return std::vector<std::string>{
                                 c->models.empty() ? "of one model" : "of models in turn"};
                           }});
  const auto describe = [](auto* options, config::Table* table) { Describe(options, table); };
  const auto of = [c](const char* name) { return VehicleOwner(c, {name}); };
  t->Thing(of("fully_actuated"), "vehicle.fully_actuated", c, DescribeFullyActuated);
  t->Thing(of("torpedo"), "vehicle.torpedo", &c->torpedo, describe);
  t->Thing(of("kinematic"), "vehicle.kinematic", &c->kinematic, describe);
  for (const char* key : {"r_BB_m", "weight_n", "buoyancy_n"}) {
    t->Own(std::string("vehicle.fully_actuated.") + key,
           {"vehicle", {"with restoring forces"}, "vehicle.fully_actuated.restoring", [c] {
              return std::vector<std::string>{c->restoring ? "with restoring forces"
                                                           : "without restoring forces"};
            }});
  }
  Vehicles().Describe("vehicle", "vehicle.model", of("").chosen, &c->kinds, t);
  for (const char* key : {"mass_kg", "inertia_kgm2", "added_mass", "linear_damping",
                          "quadratic_damping", "r_BG_m", "r_BB_m", "weight_n", "buoyancy_n",
                          "added_mass_coriolis", "reversed_coriolis", "restoring", "float32_tau"}) {
    t->Moved(std::string("vehicle.") + key, std::string("vehicle.fully_actuated.") + key);
  }
}

std::optional<config::Violation> FindConflict(const VehicleConfig& c) {
  if (!MassMatrixIsPositive(c)) {
    return config::Violation{
        {"vehicle.fully_actuated.r_BG_m", "vehicle.fully_actuated.inertia_kgm2"},
        "the mass matrix is not positive definite"};
  }
  return {};
}

}  // namespace stg::dynamics

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "auv_common/config/options.hpp"
#include "auv_dynamics/vehicle/kinematic_config.hpp"
#include "auv_dynamics/vehicle/torpedo_config.hpp"

namespace stg::dynamics {

/// How the equations of motion are stepped; the release's is semi-implicit Euler.
enum class Integrator { kSemiImplicit, kRk4 };
/// Their names in files and on command lines, in the same order.
std::vector<std::string> IntegratorNames();

/// Added-mass part of C(nu); the rigid-body part is always there.
enum class AddedMassCoriolis { kFull, kNoMunk, kOff };

/// Vehicle constants in Fossen's notation; Table S2. Six-component arrays are
/// ordered surge, sway, heave, roll, pitch, yaw. The hull's constants, from the mass to the limits
/// of the actuators, are those of `fully_actuated`; other models have sections of their own.
struct VehicleConfig {
  std::string model = "fully_actuated";  ///< name in the registry of vehicles
  std::vector<std::string> models;       ///< of a mixed fleet, in turn; otherwise empty
  std::string profile = "remus100";
  double mass_kg = 31.9;
  std::array<double, 3> inertia_kgm2{0.16, 4.10, 4.10};
  std::array<double, 6> added_mass{-2.0, -35.0, -35.0, -0.12, -4.5, -4.5};
  std::array<double, 6> linear_damping{4.0, 8.0, 10.0, 0.8, 3.0, 2.5};
  std::array<double, 6> quadratic_damping{18.0, 30.0, 35.0, 0.25, 1.2, 1.0};
  std::array<double, 3> r_BG_m{0.0, 0.0, 0.0};   ///< centre of gravity from the body origin
  std::array<double, 3> r_BB_m{0.0, 0.0, 0.02};  ///< centre of buoyancy from the body origin
  double weight_n = 312.939;
  double buoyancy_n = 312.939;
  AddedMassCoriolis added_mass_coriolis = AddedMassCoriolis::kNoMunk;
  bool reversed_coriolis = false;  ///< the release's sign error: C(nu) nu enters negated
  bool restoring = true;
  std::array<double, 3> max_velocity_mps{1.5, 0.5, 0.5};
  std::array<double, 3> max_rate_radps{1.2, 1.2, 1.2};
  bool clip_velocity = true;  ///< clip body velocity and rates to the limits
  std::array<double, 6> max_tau{35.0, 20.0, 20.0, 8.0, 10.0, 10.0};
  bool float32_tau = false;  ///< round force and torque to float32 (release)
  Integrator integrator = Integrator::kRk4;
  int substeps = 1;                  ///< integrator steps per physics step
  double radius_m = 0.011;           ///< collision radius
  TorpedoConfig torpedo;             ///< read by that model alone
  KinematicConfig kinematic;         ///< read by that model alone
  config::OptionsByName kinds = {};  ///< options of models that are registered

  /// Name of the model of AUV i.
  const std::string& model_of(int i) const {
    return models.empty() ? model : models[static_cast<std::size_t>(i) % models.size()];
  }
};

/// Keys, units and ranges of the section.
void Describe(VehicleConfig* c, config::Table* t);
/// Whether a vehicle of the fleet limits its rates to max_rate_radps.
bool LimitsRates(const VehicleConfig& c);
/// Owner of keys that only these vehicle models read.
config::Owner VehicleOwner(const VehicleConfig* c, std::vector<std::string> models);
/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const VehicleConfig& c);

}  // namespace stg::dynamics

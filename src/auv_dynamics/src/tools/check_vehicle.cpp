#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "auv_common/command_line.hpp"
#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/program.hpp"
#include "auv_dynamics/playback/recorded_motion.hpp"
#include "auv_dynamics/vehicle/torpedo.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace {

using stg::dynamics::MotionError;
using stg::dynamics::RecordedMotion;

/// Columns that do not move have an infinite share, which is null in JSON.
nlohmann::json JsonOf(const MotionError& e) {
  nlohmann::json columns;
  for (int c = 0; c < stg::dynamics::kMotionColumns; ++c) {
    const auto& column = e.columns[static_cast<std::size_t>(c)];
    columns[stg::dynamics::NameOf(static_cast<stg::dynamics::MotionColumn>(c))] = {
        {"max_abs_error", column.max_abs_error},
        {"range", column.hi - column.lo},
        {"share", column.share()},
        {"line", column.line}};
  }
  return {{"columns", columns},
          {"position", {{"share_of_distance_run", e.position_share}, {"line", e.position_line}}},
          {"motions", e.motions},
          {"rows", e.rows}};
}

void Print(const char* what, const MotionError& e) {
  std::printf("%s: %d motions, %d rows\n  column  largest error        range     share  line\n",
              what, e.motions, e.rows);
  for (int c = 0; c < stg::dynamics::kMotionColumns; ++c) {
    const auto& column = e.columns[static_cast<std::size_t>(c)];
    std::printf("  %-6s  %13.4g  %11.4g  %6.3f %%  %4d\n",
                stg::dynamics::NameOf(static_cast<stg::dynamics::MotionColumn>(c)),
                column.max_abs_error, column.hi - column.lo, 1e2 * column.share(), column.line);
  }
  std::printf("  position error at most %.4f %% of the distance run (line %d)\n",
              1e2 * e.position_share, e.position_line);
}

/// Throws UserError for an override that has no effect here.
void RequireKeysOfVehicle(const std::vector<std::string>& overrides) {
  const std::string vehicle = "vehicle.", integrator = vehicle + "integrator=";
  for (const std::string& text : overrides) {
    if (text.rfind(vehicle, 0) != 0) {
      throw stg::UserError("--set '" + text + "': check_vehicle reads only the keys " + vehicle +
                           "* of a scenario");
    }
    for (const char* key : {"radius_m", "max_velocity_mps", "max_rate_radps", "profile"}) {
      if (text.rfind(vehicle + key + "=", 0) != 0) continue;
      throw stg::UserError("--set '" + text +
                           "': a motion of a torpedo does not depend on this key");
    }
    if (text.rfind(integrator, 0) == 0) {
      throw stg::UserError("--set '" + text +
                           "': use the option --integrator in place of this key");
    }
  }
}

}  // namespace

/// Replays recorded vehicle motions. The last line is JSON. Exit status 1: beyond the tolerance; 2:
/// unusable input.
int main(int argc, char** argv) {
  stg::CommandLine app(
      "check_vehicle",
      "Simulates recorded motions of a torpedo-shaped vehicle with vehicle.model torpedo and "
      "compares every column: speeds, rates and attitude by their range over the file, positions "
      "by the distance run. Each motion starts from rest at the origin under one command; frames "
      "are NED and FRD, units SI and radians unless the header says otherwise.");
  std::string file, scenario;
  std::vector<std::string> overrides;
  double tolerance = 0.01, dt_s = 0.02;
  auto integrator = stg::dynamics::Integrator::kSemiImplicit;
  bool over_ground = false;
  app.Add("file", &file,
          "CSV: rpm,rudder_deg,stern_deg,Vc,beta_deg,t,x,y,z,phi,theta,psi,u,v,w,p,q,r")
      .Required();
  app.Add("--tolerance", &tolerance, "largest allowed error, as a share of range or distance")
      .ShowDefault();
  app.Add("--dt", &dt_s, "largest physics step [s]").ShowDefault();
  app.Add("--integrator", stg::config::Enum(&integrator, stg::dynamics::IntegratorNames()),
          "used in place of the scenario's vehicle.integrator; the default is that of the public "
          "model of the shipped motions");
  app.Add("--scenario", &scenario,
          "use the torpedo of this scenario (name or file); default: the REMUS 100");
  app.Add("--set", &overrides,
          "override vehicle.KEY=value of the scenario, for example vehicle.substeps=2")
      .Needs("--scenario");
  app.Add("--advance-over-ground", &over_ground,
          "propeller inflow from the speed over ground, as in the public model");
  app.AddPlugins();
  return app.Run(argc, argv, [&] {
    stg::CheckOption("--tolerance", tolerance, 0.0, 1e6);
    stg::CheckOption("--dt", dt_s, 1e-4, 1.0);
    stg::dynamics::VehicleConfig vehicle;
    RequireKeysOfVehicle(overrides);
    if (!scenario.empty()) {
      const auto source =
          stg::config::NamedSource(stg::config::ScenarioFolder(), scenario, "nominal", overrides);
      vehicle =
          stg::config::Load<stg::dynamics::WorldScenario>(source, stg::config::Scope::kOwnSections)
              .world.vehicle;
      const std::string& model = vehicle.model_of(0);
      const auto flown = stg::dynamics::Vehicles().Make(model, vehicle.kinds, vehicle);
      if (dynamic_cast<const stg::dynamics::Torpedo*>(flown.get()) == nullptr) {
        throw stg::UserError("--scenario: '" + scenario + "' has the model " + model +
                             ", but recorded motions are those of a torpedo (--set "
                             "vehicle.model=torpedo)");
      }
    }
    vehicle.integrator = integrator;
    if (over_ground) vehicle.torpedo.advance_over_ground = true;
    std::vector<RecordedMotion> still = stg::dynamics::LoadMotions(file);
    const auto begin_of_current = std::stable_partition(
        still.begin(), still.end(), [](const RecordedMotion& m) { return m.current_mps == 0.0; });
    const std::vector<RecordedMotion> moving(begin_of_current, still.end());
    still.erase(begin_of_current, still.end());

    const MotionError in_still = Compare(vehicle, still, dt_s);
    const MotionError in_current = Compare(vehicle, moving, dt_s);
    // In the public model, the current does not affect the propeller and does not turn with pitch;
    // here it does. So motions in a current are shown but not judged, unless there are no others.
    const bool judged = still.empty();
    const bool pass = (judged ? in_current : in_still).Within(tolerance);
    if (!still.empty()) Print("without current", in_still);
    if (!moving.empty()) Print(judged ? "in a current" : "in a current, not judged", in_current);
    nlohmann::json json = JsonOf(in_still);
    json["file"] = file;
    json["tolerance"] = tolerance;
    json["pass"] = pass;
    if (!moving.empty()) {
      json["in_current"] = JsonOf(in_current);
      json["in_current"]["judged"] = judged;
    }
    stg::PrintResult(json);
    return pass ? 0 : 1;
  });
}

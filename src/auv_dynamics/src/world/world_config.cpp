#include "auv_dynamics/world/world_config.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/config/value.hpp"
#include "auv_common/names.hpp"
#include "auv_dynamics/autopilot/autopilot.hpp"
#include "auv_dynamics/vehicle/vehicle.hpp"

namespace stg::dynamics {
namespace {

using config::Violation;

/// True if all AUVs can be drawn one after the other with this separation around one point (targets
/// may start together). Balls of half the separation must fill a smaller share of the shell's
/// volume than random placement reaches (about 0.38).
bool StartsFit(const ResetConfig& reset, const ResetStageConfig& stage, int agents) {
  constexpr double kShare = 0.25;
  const double half = 0.5 * reset.min_separation_m;
  const double outer = stage.auv_distance_m.hi + half;
  const double inner = std::max(0.0, stage.auv_distance_m.lo - half);
  return agents == 1 ||
         agents * half * half * half <= kShare * (outer * outer * outer - inner * inner * inner);
}

std::optional<Violation> CheckStage(const WorldConfig& s, int agents, int index) {
  const char* const names[] = {"easy", "medium", "hard"};
  const std::string path = std::string("reset.stages.") + names[index] + ".";
  const ResetStageConfig& stage = s.reset.stages[static_cast<std::size_t>(index)];
  const Deploy deploy = s.reset.deploy;
  if (stage.target_radius_m.hi > s.workspace.half_extent_m) {
    return Violation{{path + "target_radius_m", "workspace.half_extent_m"},
                     "a target would start outside the walls"};
  }
  if (stage.target_speed_mps.hi > s.target.max_speed_mps) {
    return Violation{{path + "target_speed_mps", "target.max_speed_mps"},
                     "a target would start faster than its largest speed"};
  }
  if (deploy != Deploy::kArea && stage.auv_distance_m.lo > s.reset.start_half_extent_m) {
    return Violation{{path + "auv_distance_m", "reset.start_half_extent_m"},
                     "AUVs cannot start this far from a target within the start region"};
  }
  if (deploy == Deploy::kAround && !StartsFit(s.reset, stage, agents)) {
    return Violation{{"agents", path + "auv_distance_m", "reset.min_separation_m"},
                     "so many AUVs do not fit around a target at this separation"};
  }
  return {};
}

/// Keys of other sections that not all vehicles read.
void OwnByVehicle(WorldConfig* c, config::Table* t) {
  const std::vector<std::string> models = Vehicles().Names(), steered = Autopilots().Names();
  const auto own = [c, t](const std::string& key, const std::vector<std::string>& names) {
    t->Own(key, VehicleOwner(&c->vehicle, names));
  };
  // Forces do not move a kinematic vehicle.
  for (const char* section : {"disturbance", "contact"}) {
    own(section, Without(models, {"kinematic"}));
  }
  for (const char* key :
       {"velocity_gain", "attitude_gain", "rate_gain", "heading", "heading_gain"}) {
    own(std::string("control.") + key, Without(models, steered));
  }
  own("control.autopilot", steered);
  // A kinematic vehicle follows the command itself, so these loops do not exist.
  for (const char* key : {"speed_integral_ps", "turn_gain_ps", "turn_integral_ps2", "max_pitch_rad",
                          "climb_integral_ps", "pitch_frequency_radps", "pitch_integral_ps3"}) {
    own(std::string("control.autopilot.") + key, Without(steered, {"kinematic"}));
  }
}

}  // namespace

void Describe(WorldConfig* c, config::Table* t) {
  Describe(&c->vehicle, t);
  Describe(&c->current, t);
  Describe(&c->disturbance, t);
  Describe(&c->contact, t);
  Describe(&c->workspace, t);
  Describe(&c->sea, t);
  for (const char* key : {"restitution", "tangential", "body_velocity", "body_rate"}) {
    t->Own(std::string("workspace.") + key, WallsOwner(&c->sea));
  }
  Describe(&c->target, t);
  Describe(&c->reset, t);
  Describe(&c->navigation, t);
  Describe(&c->sensing, t);
  Describe(&c->control, t);
  Autopilots().Describe("control.autopilot", "vehicle.model", VehicleOwner(&c->vehicle, {}).chosen,
                        &c->control.autopilot.kinds, t);
  OwnByVehicle(c, t);
}

const std::vector<std::string>& KeysOnBoard() {
  // Of the torpedo, only the keys that its autopilot reads.
  static const std::vector<std::string> keys{
      "vehicle.max_velocity_mps",
      "vehicle.max_rate_radps",
      "vehicle.max_tau",
      "vehicle.torpedo.length_m",
      "vehicle.torpedo.diameter_m",
      "vehicle.torpedo.cg_below_m",
      "vehicle.torpedo.drag_coefficient",
      "vehicle.torpedo.yaw_time_s",
      "vehicle.torpedo.pitch_damping",
      "vehicle.torpedo.fin_area_m2",
      "vehicle.torpedo.rudder_lift",
      "vehicle.torpedo.stern_plane_lift",
      "vehicle.torpedo.max_fin_rad",
      "vehicle.torpedo.propeller_diameter_m",
      "vehicle.torpedo.max_propeller_rpm",
      "vehicle.torpedo.thrust_coefficient",
      "vehicle.torpedo.propeller_advance",
      "vehicle.torpedo.propeller_inflow",
      "vehicle.torpedo.thrust_deduction",
      "workspace.half_extent_m",
      "sea.bottom_m",
      "sea.auv_depth_m",
      "sea.target_depth_m",
      "sea.spheres",
      "sea.cylinders",
      "target.max_speed_mps",
      "navigation.dead_reckoning.dvl_scale_std",
      "navigation.dead_reckoning.dvl_noise_mps",
      "navigation.dead_reckoning.heading_std_deg",
      "navigation.dead_reckoning.gyro_walk_deg_per_sqrt_h",
      "navigation.dead_reckoning.depth_std_m",
      "navigation.dead_reckoning.gps_std_m",
      "navigation.dead_reckoning.start_std_m",
      "navigation.dead_reckoning.current_std_mps",
      "sensing.range_m",
      "sensing.detection_probability",
  };
  return keys;
}

WorldConfig Believed(WorldConfig world, const config::Differences& agent_model) {
  if (agent_model.empty()) return world;
  config::Table table;
  Describe(&world, &table);
  config::Apply(agent_model, table);
  return world;
}

std::optional<config::Violation> FindConflict(const WorldConfig& s, const RunConfig& run) {
  if (auto violation = FindConflict(s.vehicle)) return violation;
  if (auto violation = FindConflict(s.current)) return violation;
  if (auto violation = FindConflict(s.sea)) return violation;
  if (auto violation = FindConflict(s.sensing, run.decision_dt_s())) return violation;
  for (const std::string& model : s.vehicle.models) {
    if (Autopilots().Has(model) == Autopilots().Has(s.vehicle.models[0])) continue;
    return Violation{{"vehicle.models"},
                     "vehicles that an autopilot steers and vehicles that take force and moment "
                     "cannot be in one fleet"};
  }
  if (Autopilots().Has(s.vehicle.model_of(0))) {
    if (s.control.interface != ActionInterface::kVelocity3) {
      return Violation{{"control.interface", "vehicle.model"},
                       "these vehicles take velocity commands only: set velocity3"};
    }
    if (run.time.decision_steps % s.control.autopilot.period_steps != 0) {
      return Violation{{"control.autopilot.period_steps", "time.decision_steps"},
                       "a decision must be a whole number of the autopilot's periods"};
    }
  }
  if (s.vehicle.radius_m >= s.workspace.half_extent_m) {
    return Violation{{"vehicle.radius_m", "workspace.half_extent_m"},
                     "an AUV does not fit between the walls"};
  }
  if (s.target.count > run.agents) {
    return Violation{{"target.count", "agents"}, "there cannot be more targets than AUVs"};
  }
  if (s.reset.start_half_extent_m > s.workspace.half_extent_m) {
    return Violation{{"reset.start_half_extent_m", "workspace.half_extent_m"},
                     "AUVs would start outside the walls"};
  }
  if (s.reset.curriculum_medium_resets < s.reset.curriculum_easy_resets) {
    return Violation{{"reset.curriculum_medium_resets", "reset.curriculum_easy_resets"},
                     "the medium stage cannot end before the easy one"};
  }
  if (s.reset.deploy != Deploy::kAround && !s.sea.open) {
    return Violation{{"reset.deploy", "sea.open"},
                     "in a closed basin AUVs start around their targets"};
  }
  for (int i = 0; i < 3; ++i) {
    if (!s.reset.curriculum && static_cast<int>(s.reset.stage) != i) continue;
    if (auto violation = CheckStage(s, run.agents, i)) return violation;
  }
  return {};
}

void Describe(WorldScenario* s, config::Table* t) {
  Describe(&s->run, t);
  TakeSeedFromCommand(t);
  Describe(&s->world, t);
  t->Differ("believed", KeysOnBoard(), &s->agent_model);
}

std::optional<config::Violation> FindConflict(const WorldScenario& s) {
  if (auto violation = FindConflict(s.run)) return violation;
  return FindConflict(s.world, s.run);
}

}  // namespace stg::dynamics

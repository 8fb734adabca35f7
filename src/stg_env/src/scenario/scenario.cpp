#include "stg_env/scenario/scenario.hpp"

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/names.hpp"
#include "auv_dynamics/autopilot/autopilot.hpp"
#include "auv_dynamics/vehicle/vehicle_set.hpp"
#include "stg_env/task/reward_term.hpp"

namespace stg {
namespace {

/// Agents command a velocity, so an autopilot must turn it into commands to the actuators. Vehicles
/// that take force and moment need none.
std::optional<config::Violation> FindUnsteered(const Scenario& s) {
  const dynamics::VehicleConfig& vehicle = s.world.vehicle;
  const std::string& model = vehicle.model_of(0);
  if (dynamics::Autopilots().Has(model) ||
      dynamics::VehicleSet(vehicle, 1).command_size() == dynamics::kWrenchSize) {
    return {};
  }
  return config::Violation{{vehicle.models.empty() ? "vehicle.model" : "vehicle.models"},
                           "no autopilot is registered for '" + model +
                               "', which does not take force and moment; set " +
                               "vehicle.model to a vehicle with an autopilot (" +
                               JoinNames(dynamics::Autopilots().Names()) +
                               "), or register an autopilot '" + model + "' beside the vehicle"};
}

}  // namespace

void Scenario::ValidateOrThrow() const { config::ValidateOrThrow(*this); }

void Describe(Scenario* s, config::Table* t) {
  DescribeTop(&s->run, t);
  TakeSeedFromCommand(t);
  t->Add("mode", config::Enum(&s->mode, {"truth", "acoustic"}), config::kNone, "-",
         "what agents know. truth: true states; acoustic: own sensors and received packets");
  Describe(&s->run.time, t);
  Describe(&s->world, t);
  Describe(&s->channel, t);
  Describe(&s->agent, t);
  Describe(&s->reward, t);
  Describe(&s->critic, t);
  // In mode `truth` there are no instruments and packets. Links between true states follow Eq. 5.
  const config::Owner acoustic{"information mode", {"acoustic"}, "mode", [s] {
                                 const bool truth = s->mode == InformationMode::kTruth;
                                 return std::vector<std::string>{truth ? "truth" : "acoustic"};
                               }};
  for (const char* key : {"channel", "navigation", "sensing", "track", "localization", "stations",
                          "task.lost_error_m"}) {
    t->Own(key, acoustic);
  }
  const auto truth = [s] { return s->mode == InformationMode::kTruth; };
  t->AlsoReadIf("channel.range_m", truth);
  t->AlsoReadIf("sensing.range_m", truth);
  // A file may state the model that the links of this mode follow.
  const std::string eq5 = "range";
  t->AlsoReadIf("channel.model", [s, truth, eq5] { return truth() && s->channel.model == eq5; });
  // A metric of open water counts the decisions in which two AUVs are closer.
  t->AlsoReadIf("reward.separation_distance_m", [s] { return s->world.sea.open; });
  agent::OwnAcrossSections(&s->world, &s->channel, &s->agent, t);
  for (const std::string& term : task::TermsOfOpenWater()) {
    t->Own("reward.terms." + term,
           {"world", {"open water"}, "sea.open", [s] {
              return std::vector<std::string>{s->world.sea.open ? "open water" : "walls"};
            }});
  }
  t->Own("reward.terms.obstacle",
         {"sea",
          {"obstacles"},
          "sea.spheres",
          [s] {
            const dynamics::SeaConfig& sea = s->world.sea;
            const bool empty = sea.spheres.empty() && sea.cylinders.empty();
            return std::vector<std::string>{empty ? "no obstacles" : "obstacles"};
          },
          {"sea.cylinders"},
          true});
  // Estimates of true states have no errors.
  for (const char* key : {"good_m", "fall_m"}) {
    t->Own(std::string("reward.terms.estimate.") + key, acoustic);
  }
  agent::DescribeBelieved(&s->agent, &s->agent_model, t);
  // In mode `truth` no estimate needs the depth of a target.
  t->Own("believed.sea.target_depth_m", acoustic);
}

std::optional<config::Violation> FindConflict(const Scenario& s) {
  if (auto violation =
          FindConflict(agent::AgentScenario{s.run, s.world, s.channel, s.agent, s.agent_model})) {
    return violation;
  }
  const bool truth = s.mode == InformationMode::kTruth;
  if (truth && s.agent.task.free()) {
    return config::Violation{
        {"task.assignment", "mode"},
        "AUVs choose targets by their own estimates, which only the mode acoustic has"};
  }
  if (s.agent.fleet.changes() && (truth || !s.world.sea.open)) {
    return config::Violation{{"fleet.leave", "mode", "sea.open"},
                             "AUVs can leave and join only in open water and in the mode acoustic"};
  }
  if (auto violation = FindUnsteered(s)) return violation;
  return FindConflict(s.judge());
}

Scenario LoadScenario(const std::string& file, const std::vector<std::string>& overlays,
                      const std::vector<std::string>& overrides) {
  return config::Load<Scenario>({file, overlays, overrides});
}

Scenario LoadNamedScenario(const std::string& folder, const std::string& scenario,
                           const std::string& condition,
                           const std::vector<std::string>& overrides) {
  return config::Load<Scenario>(config::NamedSource(folder, scenario, condition, overrides));
}

void RefuseKeysOfTraining(const std::vector<std::string>& overrides, const std::string& program) {
  for (const std::string& text : overrides) {
    for (const char* keys : {"critic.", "reset.curriculum", "control.action_scale"}) {
      if (text.rfind(keys, 0) != 0) continue;
      throw UserError("'" + text + "': only a training reads this key, but " + program +
                      " does not train");
    }
  }
}

std::string ToYaml(const Scenario& scenario) { return config::ToYaml(scenario); }

std::string ScenarioHash(const Scenario& scenario) { return config::HashOfKeys(scenario); }

}  // namespace stg

#include "stg_env/scenario/scenario.hpp"

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"

namespace stg {

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
  for (const char* section : {"channel", "navigation", "sensing", "track"}) {
    t->Own(section, acoustic);
  }
  // A run of nodes has always the mode `acoustic`. It may read these keys of the same file.
  for (const char* key : {"channel.model", "channel.access", "navigation.kind", "sensing.sensor",
                          "track.filter", "channel.range_m", "sensing.range_m"}) {
    t->AlsoReadIf(key, [] { return true; });
  }
  t->Differ("believed", agent::KeysOfModel(), &s->agent_model);
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
    for (const char* keys : {"critic.", "reset.curriculum"}) {
      if (text.rfind(keys, 0) != 0) continue;
      throw UserError("--set '" + text + "': only a training reads this key, but " + program +
                      " does not train");
    }
  }
}

std::string ToYaml(const Scenario& scenario) { return config::ToYaml(scenario); }

std::string ScenarioHash(const Scenario& scenario) { return config::HashOfKeys(scenario); }

}  // namespace stg

#include "stg_env/scenario/scenario.hpp"

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"

namespace stg {

void Scenario::ValidateOrThrow() const { config::ValidateOrThrow(*this); }

void Describe(Scenario* s, config::Table* t) {
  DescribeTop(&s->run, t);
  t->Add("mode", config::Enum(&s->mode, {"truth", "acoustic"}), config::kNone, "-",
         "what agents know: true states, or own sensors and received packets");
  Describe(&s->run.time, t);
  Describe(&s->world, t);
  Describe(&s->channel, t);
  Describe(&s->agent, t);
  Describe(&s->reward, t);
}

std::optional<config::Violation> FindConflict(const Scenario& s) {
  if (auto violation = FindConflict(agent::AgentScenario{s.run, s.world, s.channel, s.agent})) {
    return violation;
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

std::string ToYaml(const Scenario& scenario) { return config::ToYaml(scenario); }

std::string ScenarioHash(const Scenario& scenario) { return config::HashOfKeys(scenario); }

}  // namespace stg

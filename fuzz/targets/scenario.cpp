#include "stg_env/scenario/scenario.hpp"

#include <utility>

#include "auv_common/config/loader.hpp"
#include "target.hpp"

namespace {

/// What LoadScenario does, with one table for all files: to describe 300 keys takes longer than to
/// read most of them.
class ScenarioLoader {
 public:
  ScenarioLoader() { Describe(&scenario_, &table_); }

  const stg::Scenario& Load(const std::string& file) {
    // The table points to the values of this map.
    auto terms = std::move(scenario_.reward.terms);
    for (auto& [name, weight] : terms) weight = 0.0;
    scenario_ = stg::Scenario();
    scenario_.reward.terms = std::move(terms);
    stg::config::Loader loader(table_, stg::config::Scope::kWhole);
    loader.Apply({file});
    if (const auto violation = FindConflict(scenario_)) loader.Refuse(*violation);
    return scenario_;
  }

 private:
  stg::Scenario scenario_;
  stg::config::Table table_;
};

}  // namespace

/// A scenario file. What is accepted is the same when it is written and read again.
bool stg::fuzz::RunScenario(const std::string& bytes) {
  static ScenarioLoader loader;
  return LoadAsFile(bytes, [](const std::string& path) {
    const std::string text = ToYaml(loader.Load(path));
    const auto again = config::LoadText<Scenario>(text, "again");
    Require(ToYaml(again) == text, "a scenario is another one when it is written and read again");
  });
}

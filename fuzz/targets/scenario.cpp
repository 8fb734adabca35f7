#include "stg_env/scenario/scenario.hpp"

#include "auv_common/config/loader.hpp"
#include "target.hpp"

/// A scenario file. An accepted one is the same after it is written and read again.
bool stg::fuzz::RunScenario(const std::string& bytes) {
  return LoadAsFile(bytes, [](const std::string& path) {
    const std::string text = ToYaml(LoadScenario(path));
    const auto again = config::LoadText<Scenario>(text, "again");
    Require(ToYaml(again) == text, "a scenario is another one when it is written and read again");
  });
}

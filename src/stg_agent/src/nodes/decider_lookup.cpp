#include "decider_lookup.hpp"

#include <ros/console.h>

#include <filesystem>
#include <set>
#include <string>
#include <system_error>

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/names.hpp"
#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {

namespace {

namespace fs = std::filesystem;

std::string ShippedScenario(const std::string& name) {
  return config::ScenarioFolder() + "/" + name + ".yaml";
}

std::string Resolve(const std::string& name, const agent::AgentModel& model, int agent) {
  if (name != "auto") return name;
  std::string shipped = config::ScenarioFolder() + "/../policies/" + model.run.name + ".onnx";
  std::error_code ignored;
  if (fs::exists(shipped, ignored)) return shipped;
  // If the scenario is derived from a shipped one, the user may expect the policy of that one.
  if (agent == 0 && !fs::exists(ShippedScenario(model.run.name), ignored)) {
    ROS_WARN(
        "no policy is shipped for a scenario named '%s', so the controller '%s' decides; "
        "policy:=FILE.onnx chooses a policy",
        model.run.name.c_str(), agent::DefaultController().c_str());
  }
  return agent::DefaultController();
}

/// Names of the shipped scenarios that the policy fits, for the message that refuses this one.
std::string WhereItFits(const agent::Policy& policy) {
  std::set<std::string> names;
  std::error_code ignored;
  for (const auto& file : fs::directory_iterator(config::ScenarioFolder(), ignored)) {
    if (file.path().extension() != ".yaml") continue;
    const std::string name = file.path().stem().string();
    try {
      policy.RequireFits(
          config::Load<agent::AgentScenario>(
              config::NamedSource(config::ScenarioFolder(), name, "nominal", {"mode=acoustic"}),
              config::Scope::kOwnSections)
              .model());
      names.insert(name);
    } catch (const UserError&) {
      continue;
    }
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "" : "; of the shipped scenarios it fits scenario:= " + text;
}

}  // namespace

agent::Decider DeciderFor(const std::string& name, const agent::AgentModel& model, int id) {
  // Answers and logs repeat the name.
  if (!IsText(name)) throw UserError("policy: must be UTF-8 without control characters");
  agent::Decider decider = agent::ReadDecider(Resolve(name, model, id), id, id + 1);
  if (decider.entities != nullptr) decider.entities->RequireFits(model);
  for (const auto& policy : decider.policies) {
    try {
      policy->RequireFits(model);
    } catch (const UserError& error) {
      throw UserError(error.what() + WhereItFits(*policy));
    }
  }
  return decider;
}

bool ExploreParameter(const agent::Decider& decider, int id) {
  const bool explore = FlagParameter("explore", false);
  const std::string& name = decider.IdOf(id);
  if (explore && decider.FileOf(id).empty() && name != agent::WaitingController()) {
    throw UserError("parameter explore: the controller '" + name +
                    "' draws no actions at random; choose a policy file, or leave out explore");
  }
  return explore;
}

}  // namespace stg::nodes

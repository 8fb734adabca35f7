#include "decider.hpp"

#include <ros/console.h>

#include <filesystem>
#include <set>
#include <string>
#include <system_error>

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_agent/policy/gaussian.hpp"

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
  // Whoever derives a scenario from a shipped one and names it may think that its policy flies.
  if (agent == 0 && !fs::exists(ShippedScenario(model.run.name), ignored)) {
    ROS_WARN(
        "no policy is shipped for a scenario named '%s': '%s' flies; policy:=FILE.onnx says "
        "who else shall",
        model.run.name.c_str(), agent::DefaultController().c_str());
  }
  return agent::DefaultController();
}

/// Names the shipped scenarios that a policy fits, for whoever tried another one.
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

Decider::Decider(const std::string& wanted, const agent::AgentModel& model, int agent) {
  const std::string name = Resolve(wanted, model, agent);
  builtin_ = agent::MakeController(name);
  if (builtin_) {
    id_ = name;
    return;
  }
  agent::RequirePolicyFileName(name);
  file_ = agent::PolicyFileOf(name, agent);
  if (agent::EntityPolicy::IsOne(file_)) {
    entities_ = std::make_unique<const agent::EntityPolicy>(agent::EntityPolicy::LoadOnnx(file_));
    id_ = entities_->metadata().id;
    return;
  }
  policy_ = std::make_unique<const agent::Policy>(agent::Policy::LoadOnnx(file_));
  try {
    policy_->RequireFits(model);
  } catch (const UserError& error) {
    throw UserError(error.what() + WhereItFits(*policy_));
  }
  id_ = policy_->metadata().id;
}

void Decider::Mean(const agent::Agent& agent, const float* observation, float* action) const {
  if (policy_) {
    policy_->Mean(observation, action);
  } else if (entities_) {
    agent::Fly(*entities_, agent.view(), action);
  } else {
    builtin_->Act(agent.view(), action);
  }
}

float Decider::Explore(std::uint64_t seed, std::uint32_t step, int agent, float* action) const {
  if (!policy_) return 0.0F;
  const Eigen::VectorXf& log_std = policy_->parameters().log_std;
  Random random(seed, Stream::kPolicy, 0, step, static_cast<std::uint32_t>(agent));
  return agent::SampleGaussian(log_std.data(), static_cast<int>(log_std.size()), &random, action);
}

}  // namespace stg::nodes

#include "decider.hpp"

#include <fstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::nodes {

namespace {

std::string Resolve(const std::string& name, const agent::AgentModel& model) {
  if (name != "auto") return name;
  const std::string shipped = config::ScenarioFolder() + "/../policies/" + model.run.name + ".onnx";
  return std::ifstream(shipped).good() ? shipped : agent::DefaultController();
}

}  // namespace

Decider::Decider(const std::string& wanted, const agent::AgentModel& model, int agent) {
  const std::string name = Resolve(wanted, model);
  builtin_ = agent::MakeController(name);
  if (builtin_) {
    id_ = name;
    return;
  }
  agent::RequirePolicyFileName(name);
  file_ = agent::PolicyFileOf(name, agent);
  policy_ = std::make_unique<const agent::Policy>(agent::Policy::LoadOnnx(file_));
  policy_->RequireFits(model);
  id_ = policy_->metadata().id;
}

void Decider::Mean(const agent::Agent& agent, const float* observation, float* action) const {
  if (policy_) {
    policy_->Mean(observation, action);
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

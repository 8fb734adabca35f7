#include "stg_agent/decider/decider.hpp"

#include "auv_common/numbers/random.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::agent {

const Policy& Decider::PolicyOf(int id) const {
  return *policies[policies.size() == 1 ? 0 : static_cast<std::size_t>(id)];
}

void Decider::Act(int id, const float* observation, float* action) const {
  PolicyOf(id).Mean(observation, action);
}

void Decider::Act(const AgentView& agent, float* action) const {
  if (entities != nullptr) {
    Fly(*entities, agent, action);
  } else {
    builtin->Act(agent, action);
  }
}

float Decider::Explore(std::uint64_t seed, std::uint32_t step, int id, float* action) const {
  if (!observes()) return 0.0F;
  const Eigen::VectorXf& log_std = PolicyOf(id).parameters().log_std;
  Random random(seed, Stream::kPolicy, 0, step, static_cast<std::uint32_t>(id));
  return SampleGaussian(log_std.data(), static_cast<int>(log_std.size()), &random, action);
}

bool Decider::Explore(std::uint64_t seed, std::uint32_t step, const AgentView& agent,
                      EntityDecision* decision, float* action) const {
  const auto decisions =
      static_cast<std::uint32_t>(DecisionsPerCommand(agent.model().run, entities->action()));
  Random random(seed, Stream::kPolicy, 0, step / decisions, static_cast<std::uint32_t>(agent.id()));
  return FlyExploring(*entities, agent, &random, decision, action);
}

const std::string& Decider::IdOf(int id) const {
  if (observes()) return PolicyOf(id).metadata().id;
  return entities != nullptr ? entities->metadata().id : name;
}

std::string Decider::FileOf(int id) const {
  return builtin != nullptr ? std::string() : PolicyFileOf(name, id);
}

Decider ReadDecider(const std::string& name, int first, int end) {
  Decider decider;
  decider.name = name;
  decider.builtin = MakeController(name);
  if (decider.builtin) return decider;
  RequirePolicyFileName(name);
  const std::string one = PolicyFileOf(name, first);
  if (EntityPolicy::IsOne(one)) {
    decider.entities = std::make_shared<EntityPolicy>(EntityPolicy::LoadOnnx(one));
    return decider;
  }
  std::string last;
  for (int i = first; i < end; ++i) {
    const std::string file = PolicyFileOf(name, i);
    if (file == last) break;
    decider.policies.push_back(std::make_shared<Policy>(Policy::LoadOnnx(file)));
    last = file;
  }
  return decider;
}

Decider MakeDecider(const std::string& name, const AgentModel& model) {
  Decider decider = ReadDecider(name, 0, model.run.agents);
  for (const auto& policy : decider.policies) policy->RequireFits(model);
  if (decider.entities != nullptr) decider.entities->RequireFits(model);
  return decider;
}

}  // namespace stg::agent

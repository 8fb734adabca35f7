#include "stg_agent/agent/agent.hpp"

#include <algorithm>

namespace stg::agent {

Agent::Agent(const AgentModel& model, int id)
    : Agent(std::make_shared<const AgentConstants>(model), id) {}

std::vector<Agent> MakeAgents(const AgentModel& model) {
  const auto constants = std::make_shared<const AgentConstants>(model);
  std::vector<Agent> agents;
  agents.reserve(static_cast<std::size_t>(model.run.agents));
  for (int i = 0; i < model.run.agents; ++i) agents.emplace_back(constants, i);
  return agents;
}

void Agent::Observe(const dynamics::NavState& nav, float* observation) {
  one_.Observe(nav);
  BuildObservation(model(), knowledge(), [observation](int k, double value) {
    observation[k] = static_cast<float>(value);
  });
}

AgentOutput Agent::Act(const float* action) {
  double wanted[dynamics::kMaxActionSize];
  std::copy(action, action + model().control.action_size(), wanted);
  AgentOutput out;
  out.cmd_vel_W = one_.Act(wanted);
  std::copy(knowledge().tau, knowledge().tau + dynamics::kWrenchSize, out.fraction);
  std::copy(one_.action().begin(), one_.action().end(), out.action);
  return out;
}

}  // namespace stg::agent

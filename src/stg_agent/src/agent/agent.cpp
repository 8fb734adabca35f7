#include "stg_agent/agent/agent.hpp"

#include <algorithm>

namespace stg::agent {

Agent::Agent(const AgentConfig& scenario, int id)
    : Agent(std::make_shared<const AgentConstants>(scenario), id) {}

std::vector<Agent> MakeAgents(const AgentConfig& scenario) {
  const auto constants = std::make_shared<const AgentConstants>(scenario);
  std::vector<Agent> agents;
  agents.reserve(static_cast<std::size_t>(scenario.agents));
  for (int i = 0; i < scenario.agents; ++i) agents.emplace_back(constants, i);
  return agents;
}

void Agent::Observe(const dynamics::NavState& nav, float* observation) {
  one_.Observe(nav);
  BuildObservation(scenario(), knowledge(), [observation](int k, double value) {
    observation[k] = static_cast<float>(value);
  });
}

AgentOutput Agent::Act(const float* action) {
  double wanted[dynamics::kMaxActionSize];
  std::copy(action, action + scenario().action_size(), wanted);
  AgentOutput out;
  out.cmd_vel_W = one_.Act(wanted);
  std::copy(knowledge().tau, knowledge().tau + dynamics::kWrenchSize, out.fraction);
  std::copy(one_.action().begin(), one_.action().end(), out.action);
  return out;
}

}  // namespace stg::agent

#pragma once

#include "stg_agent/agent_config.hpp"

namespace stg::nodes {

/// What the agents of this run know. Throws UserError where the scenario has what the run lacks:
/// over modems there are no stations, and AUVs do not ping.
agent::AgentModel ModelOfRun();

}  // namespace stg::nodes

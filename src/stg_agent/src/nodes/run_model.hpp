#pragma once

#include "stg_agent/agent_config.hpp"

namespace stg::nodes {

/// The model of this run's agents. Throws UserError for stations or pings in a run with real
/// modems.
agent::AgentModel ModelOfRun();

}  // namespace stg::nodes

#include "stg_agent/agent/agent_constants.hpp"

#include <cmath>

namespace stg::agent {

AgentConstants::AgentConstants(const AgentConfig& s)
    : scenario(s),
      codec(s),
      slots(
          static_cast<int>(Max(1.0, std::round(s.channel.transmit_period_s / s.decision_dt_s())))),
      period(s.decision_period()) {}

}  // namespace stg::agent

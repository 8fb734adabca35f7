#pragma once

#include <memory>

#include "stg_agent/agent_config.hpp"
#include "stg_agent/estimation/target_filter.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

/// Constants that all agents of a swarm share.
struct AgentConstants {
  /// Throws UserError when the scenario does not fit the packet layout.
  explicit AgentConstants(const AgentModel& s) : model(s), codec(s, LayoutOf(s)) {}

  AgentModel model;
  PacketCodec codec;
};
using SharedConstants = std::shared_ptr<const AgentConstants>;

}  // namespace stg::agent

#pragma once

#include <optional>

#include "stg_agent/agent_config.hpp"
#include "stg_env/task/reward_config.hpp"

namespace stg::task {

/// What a task reads: what the AUVs are and are to do, and the reward.
struct JudgeConfig : agent::AgentConfig {
  RewardConfig reward;
};

/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const JudgeConfig& c);

}  // namespace stg::task

#pragma once

#include <optional>

#include "stg_agent/agent_config.hpp"
#include "stg_env/task/critic_config.hpp"
#include "stg_env/task/reward_config.hpp"

namespace stg::task {

/// What a task reads: what the AUVs are and are to do, the reward, and the
/// scales of the critic's state.
struct JudgeConfig {
  RunConfig run;
  dynamics::WorldConfig world;
  agent::AgentConfig agent;
  RewardConfig reward;
  CriticConfig critic;
};

/// Contradictions between the keys of the reward and those of the task and the vehicle.
std::optional<config::Violation> FindConflict(const JudgeConfig& c);

}  // namespace stg::task

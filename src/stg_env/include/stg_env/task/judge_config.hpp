#pragma once

#include <optional>

#include "stg_agent/agent_config.hpp"
#include "stg_env/task/reward_config.hpp"

namespace stg::task {

/// Scales of the critic's state: the length of the workspace and that of the band.
struct CriticConfig {
  double far_scale_m = 1.0;
  double near_scale_m = 0.05;
  double target_speed_gain = 20.0;  ///< the largest speed of an AUV over that of a target
};

/// Keys, units and ranges of the section `critic`, which a file may leave out.
void Describe(CriticConfig* c, config::Table* t);

/// The sections that a task reads: vehicles, task, reward, and scales of the critic's state.
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

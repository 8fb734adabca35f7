#pragma once

#include <optional>

#include "stg_agent/agent_config.hpp"
#include "stg_env/task/reward_config.hpp"

namespace stg::task {

/// Lengths by which the critic's state is divided: those of the workspace and those of the band.
struct CriticConfig {
  double far_scale_m = 1.0;
  double near_scale_m = 0.05;
  double target_speed_gain = 20.0;  ///< the largest speed of an AUV over that of a target
};

/// Keys, units and ranges of the section `critic`, which a file may leave out.
void Describe(CriticConfig* c, config::Table* t);

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

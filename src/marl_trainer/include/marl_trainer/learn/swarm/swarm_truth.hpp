#pragma once

#include "marl_trainer/learn/swarm/network/pool_batch.hpp"
#include "stg_agent/entities/entities.hpp"
#include "stg_env/env/vector_env.hpp"

/// What the critic of a swarm of any size sees: an AUV's own numbers, where everybody truly is, and
/// what truth does not show, namely how wrong the AUV's estimate is.
namespace stg::learn {

/// Of an AUV itself: its own numbers, the error of its estimate along and across the line of sight
/// and its size, and of the estimate two deviations, age, geometry of the observers (2), lost.
inline constexpr int kCriticSelf = agent::kSelfNumbers + 9;
inline constexpr int kCriticTarget = 11;  ///< of its target
inline constexpr int kCriticOther = 12;   ///< of every other AUV

/// The network of a critic.
agent::PoolSpec SwarmCriticSpec();

/// Appends what the critic sees of AUV i.
/// @param entities of that AUV now
void AddCriticRow(const env::VectorEnv& env, int e, int i, const agent::Entities& entities,
                  PackedRows* rows);

}  // namespace stg::learn

#pragma once

#include "marl_trainer/learn/swarm/network/pool_batch.hpp"
#include "stg_agent/entities/entities.hpp"
#include "stg_env/env/vector_env.hpp"

/// Input of the critic for a swarm of any size: an AUV's own numbers, the true positions of all,
/// and the error of the AUV's estimate, which the true state does not contain.
namespace stg::learn {

/// Size of an AUV's own input: its own numbers; the error of its estimate along and across the line
/// of sight, and the size of the error; two deviations of the estimate, its age, the geometry of
/// the observers (2), lost.
inline constexpr int kCriticSelf = agent::kSelfNumbers + 9;
inline constexpr int kCriticTarget = 11;  ///< size of the input of its target
inline constexpr int kCriticOther = 12;   ///< size of the input of every other AUV

/// The network of a critic.
agent::PoolSpec SwarmCriticSpec();

/// Appends the critic's input for AUV i.
/// @param entities of this AUV at present
void AddCriticRow(const env::VectorEnv& env, int e, int i, const agent::Entities& entities,
                  PackedRows* rows);

}  // namespace stg::learn

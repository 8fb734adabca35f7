#pragma once

#include <cstdint>
#include <vector>

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

/// The true state of one swarm, and what its AUVs estimate.
struct SwarmTruth {
  agent::EntityScales scales;
  double desired_m = 0.0;                ///< desired distance to a target
  std::vector<Vec3<double>> p_WB, v_WB;  ///< [agents]
  std::vector<dynamics::TargetState<double>> targets;
  std::vector<std::uint8_t> present;  ///< [agents], 0: the AUV has left the swarm
  std::vector<int> followed;          ///< [agents], the target that the AUV follows
  std::vector<Vec3<double>> r_BT_W;   ///< [agents], estimated vector from the AUV to its target
};

/// The same of an environment at present.
void ReadTruth(const env::VectorEnv& env, int e, SwarmTruth* truth);

/// Appends the critic's input for AUV i.
/// @param entities of this AUV at present
void AddCriticRow(const SwarmTruth& truth, int i, const agent::Entities& entities,
                  PackedRows* rows);

}  // namespace stg::learn

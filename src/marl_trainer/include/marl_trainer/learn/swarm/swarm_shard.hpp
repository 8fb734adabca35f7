#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/swarm/network/entity_actor.hpp"
#include "marl_trainer/learn/swarm/swarm_config.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::learn {

/// What one shard saw in a collection. Row of AUV i of environment e at policy step t:
/// (t envs + e) agents + i.
struct SwarmRollout {
  SwarmRollout();

  int steps = 0, envs = 0, agents = 0;
  PackedRows actor, critic;
  std::vector<float> commands;      // [rows, command size], unclipped
  std::vector<int> choices;         // [rows], of what the network could choose from
  std::vector<float> log_prob;      // [rows]
  std::vector<float> own, rewards;  // [rows], the AUV's own mean reward; what it learns from
  std::vector<std::uint8_t> done;   // [rows], the episode ended with this step
  PackedRows finals;                // critic's rows of the states that ended an episode,
  std::vector<int> final_of;        // [rows], which of them; -1: the episode went on
  PackedRows next;                  // critic's rows of the state after the last step
  std::vector<float> values, advantages, returns;  // [rows], by the learner
  std::vector<task::EpisodeMetrics> finished;      // episodes that ended
};

/// The actor as a shard needs it.
struct SwarmActor {
  const EntityActor& network;
  const float* parameters;
  const float* log_std;  ///< [command size]
};

/// What a decision in the band of a target pays one of the `inside` AUVs there, as a share of what
/// it pays one alone: of targets that are chosen two AUVs are enough, whose ranges tell where it
/// is, and more of them share the pay of two.
double ShareOfBand(bool chosen, int inside);
/// What such a decision pays everybody: mean over the targets of the AUVs in its band as a share of
/// two, 1 at most. @param inside of each target
double ShareCovered(const std::vector<int>& inside);

/// Environments of one scenario, so of one size of swarm, that one worker flies on its own.
class SwarmShard {
 public:
  /// @param first_env index of the first environment among all, @param total_envs of all
  SwarmShard(const env::EnvFactory& make_env, const SwarmConfig& config, int first_env, int envs,
             int total_envs);

  /// Starts the k-th episode of every environment; their first ones are cut to different lengths.
  void RestartAt(std::uint64_t k);
  /// `config.horizon` policy steps with exploration. @param collection keys the draws
  void Collect(std::uint32_t collection, const SwarmActor& actor, SwarmRollout* out);

 private:
  void Observe(const SwarmActor& actor, std::uint32_t collection, int step, SwarmRollout* out);
  void FlyOn(int step, SwarmRollout* out);
  /// Adds what the decision that was just flown pays to sums_.
  void Pay();
  void Reward(int step, SwarmRollout* out) const;
  double Potential(int e, int i) const;

  SwarmConfig config_;
  int first_env_;
  env::VectorEnv env_;
  env::EnvMemory memory_;
  std::vector<agent::Entities> entities_;  // [envs, agents]
  std::vector<float> actions_, sums_, potential_, next_potential_;
  PackedRows now_, last_;
  ActorWorkspace workspace_;
  std::vector<float> log_shares_;
};

}  // namespace stg::learn

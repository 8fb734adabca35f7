#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "marl_trainer/learn/swarm/network/entity_actor.hpp"
#include "marl_trainer/learn/swarm/swarm_config.hpp"
#include "marl_trainer/learn/swarm/swarm_reward.hpp"
#include "marl_trainer/learn/swarm/swarm_truth.hpp"
#include "stg_agent/decider/decider.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::learn {

/// The collection of one shard. The row of AUV i of environment e at policy step t is (t envs + e)
/// agents + i.
struct SwarmRollout {
  SwarmRollout();

  int steps = 0, envs = 0, agents = 0;
  PackedRows actor, critic;
  std::vector<float> commands;  // [rows, command size], unclipped
  std::vector<int> choices;     // [rows], index of the choice
  std::vector<float> log_prob;  // [rows]
  std::vector<float> taught;    // [rows, command size], of the imitated controller, or empty
  // [rows]: the AUV's own mean reward; the reward that it learns from.
  std::vector<float> own, rewards;
  // [rows], 1: nothing is learnt from this row, because the AUV had left the swarm.
  std::vector<std::uint8_t> absent;
  std::vector<std::uint8_t> done;  // [rows], 1: the episode ended with this step, or the AUV left
  PackedRows finals;               // critic's rows of the states before such an end
  std::vector<int> final_of;       // [rows], index in finals; -1: it went on
  PackedRows next;                 // critic's rows of the state after the last step
  std::vector<float> values, advantages, returns;  // [rows], written by the learner
  std::vector<task::EpisodeMetrics> finished;      // episodes that ended
};

/// The actor, as a shard uses it.
struct SwarmActor {
  const EntityActor& network;
  const float* parameters;
  const float* log_std;  ///< [command size]
};

/// Environments of one scenario, all with the same size of swarm, that one worker flies.
class SwarmShard {
 public:
  /// @param first_env index of the first environment among all, @param total_envs number of all
  SwarmShard(const env::EnvFactory& make_env, const SwarmConfig& config, int first_env, int envs,
             int total_envs);

  /// Starts the k-th episode of every environment. The first episodes are cut to different lengths.
  void RestartAt(std::uint64_t k);
  /// Makes `config.horizon` policy steps with exploration. @param collection keys the draws
  /// @param teach also ask the imitated controller in each state
  void Collect(std::uint32_t collection, const SwarmActor& actor, SwarmRollout* out,
               bool teach = false);

 private:
  void Observe(const SwarmActor& actor, std::uint32_t collection, int step, SwarmRollout* out);
  void FlyOn(int step, SwarmRollout* out);
  /// Of the last decision, and the distances after it.
  Outcome OutcomeOf(int e, int i) const;
  /// Adds the reward of the last decision to sums_.
  void Pay();
  void Reward(int step, SwarmRollout* out) const;
  float Potential(int e, int i) const;

  /// Asks the imitated controller in the present state.
  void AskTeacher(SwarmRollout* out);

  SwarmConfig config_;
  int first_env_;
  env::VectorEnv env_;
  SwarmReward reward_;
  env::EnvMemory memory_;
  std::vector<agent::Entities> entities_;  // [envs, agents]
  std::vector<float> actions_, sums_, potential_, next_potential_;
  std::vector<agent::CommandNoise> noise_;  // [envs, agents], of the exploration
  PackedRows now_, last_;
  ActorWorkspace workspace_;
  SwarmTruth truth_;
  std::optional<agent::Decider> teacher_;
  std::vector<double> teacher_actions_;  // [envs, agents, 3]
  std::vector<Outcome> outcomes_;        // [agents]
};

}  // namespace stg::learn

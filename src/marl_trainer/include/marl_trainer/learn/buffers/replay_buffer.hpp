#pragma once

#include <cstdint>
#include <vector>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {

/// Recent transitions of the environments, raw, for methods that learn from the actions of any
/// policy. It stores whole collections and forgets the oldest one first.
///
/// A sample is n steps of one environment: their discounted rewards, and the observations and state
/// after them. A sample has fewer steps if its episode or collection ends earlier. It then has the
/// state before the restart, and the discount of its steps. An episode always ends by truncation,
/// so no value is masked.
class ReplayBuffer {
 public:
  /// @param capacity environment steps; the newest collection is stored in any case
  /// @param n_step steps of a sample, >= 1. @param gamma discount of a step
  /// @param own_rewards also store the rewards of each AUV
  ReplayBuffer(const Problem& problem, std::int64_t capacity, int n_step, double gamma,
               bool own_rewards = false);

  /// Begins a collection, and forgets the oldest ones if the capacity is reached. All collections
  /// of a run must have the same shards and steps; otherwise throws UserError.
  void Begin(const Collection& collection);
  /// Different shards may be added concurrently.
  void Add(const Transition& transition);
  /// Gives the shards of all ranks to all ranks. Call it after this rank has added `count` shards
  /// of the collection, from number `first` on, and the others have added theirs.
  void Exchange(Communicator* ranks, std::size_t first, std::size_t count);

  /// Number of stored environment steps.
  std::int64_t size() const;

  /// Place of a sample.
  struct Place {
    std::size_t chunk = 0, shard = 0, sample = 0;
  };
  /// A random environment step; all are equally likely.
  Place Draw(Random* random) const;

  /// Rows of a sample, valid until the next Begin.
  struct Sample {
    const float* observations = nullptr;       ///< [agents, observation_size]
    const float* state = nullptr;              ///< [state_size]
    const float* actions = nullptr;            ///< [agents, action_size], as executed
    const float* next_observations = nullptr;  ///< after the last step
    const float* next_state = nullptr;
    float reward = 0.0F;    ///< sum of gamma^k r_k over the sample's steps; r is the team's reward
    float weight = 0.0F;    ///< sum of gamma^k
    float discount = 0.0F;  ///< gamma^steps
  };
  Sample At(const Place& place) const;
  /// Writes Sample::reward for each AUV's own rewards [agents], if they are stored.
  void OwnRewards(const Place& place, float* rewards) const;

  /// Stores everything, bit for bit.
  void Save(Archive* archive) const;
  /// Throws UserError if the sizes differ.
  void Load(const Archive& archive);

 private:
  /// Collection of one shard; index [t][e].
  struct Block {
    int steps = 0, envs = 0;
    std::vector<float> observations, states, actions, rewards;
    std::vector<float> own_rewards;  ///< [T, E, agents], or empty
    /// [T, E]: row of the last observations and states of the segment, at its last step; -1 at all
    /// other steps.
    std::vector<std::int64_t> end;
    std::vector<float> end_observations, end_states;
  };
  using Chunk = std::vector<Block>;  // by shard

  /// All arrays of a block except `end`.
  static std::vector<std::vector<float>*> Numbers(Block* block);

  void Resize(Block* block, int steps, int envs) const;

  const int agents_, observation_row_, state_row_, action_row_;
  const std::int64_t capacity_;
  const int n_step_;
  const int own_row_;          // number of stored rewards of each AUV
  std::vector<float> powers_;  // gamma^k, k = 0 .. n_step
  std::vector<Chunk> chunks_;  // used as a ring
  std::size_t newest_ = 0;
  // First sample of each shard in a chunk, then the number of all samples.
  std::vector<std::int64_t> first_;
};

}  // namespace stg::learn

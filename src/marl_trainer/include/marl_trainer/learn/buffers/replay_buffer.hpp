#pragma once

#include <cstdint>
#include <vector>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {

/// What the environments lately went through, raw, for methods that learn from any policy's
/// actions. It keeps whole collections and forgets the oldest one first.
///
/// A sample is n steps of one environment: their discounted rewards, and what was seen after them.
/// Where an episode or a collection ends earlier, so does the sample, with the state before the
/// restart and the discount of the steps it has. An episode always ends by truncation: there is
/// nothing to mask.
class ReplayBuffer {
 public:
  /// @param capacity environment steps; at least the newest collection is kept
  /// @param n_step steps of a sample, >= 1. @param gamma discount of a step
  /// @param own_rewards whether to keep the rewards of each AUV, too
  ReplayBuffer(const Problem& problem, std::int64_t capacity, int n_step, double gamma,
               bool own_rewards = false);

  /// Begins a collection, in place of the oldest ones where the capacity is reached. All
  /// collections of a run have the same shards and steps; throws UserError for others.
  void Begin(const Collection& collection);
  /// Different shards may be added concurrently.
  void Add(const Transition& transition);
  /// After this rank has added `count` shards of the collection, from number `first` on, and the
  /// others theirs, by rank: all get all.
  void Exchange(Communicator* ranks, std::size_t first, std::size_t count);

  /// Environment steps that it holds.
  std::int64_t size() const;

  /// Where a sample is.
  struct Place {
    std::size_t chunk = 0, shard = 0, sample = 0;
  };
  /// One of all environment steps, each as likely.
  Place Draw(Random* random) const;

  /// A sample's rows, valid until the next Begin.
  struct Sample {
    const float* observations = nullptr;       ///< [agents, observation_size]
    const float* state = nullptr;              ///< [state_size]
    const float* actions = nullptr;            ///< [agents, action_size], as executed
    const float* next_observations = nullptr;  ///< after the last step
    const float* next_state = nullptr;
    float reward = 0.0F;    ///< sum of gamma^k r_k over its steps, the team's reward
    float weight = 0.0F;    ///< sum of gamma^k
    float discount = 0.0F;  ///< gamma^steps
  };
  Sample At(const Place& place) const;
  /// Writes Sample::reward of each AUV's own rewards [agents], where they are kept.
  void OwnRewards(const Place& place, float* rewards) const;

  /// Everything, bit for bit.
  void Save(Archive* archive) const;
  /// Throws UserError for a buffer of other sizes.
  void Load(const Archive& archive);

 private:
  /// One shard's collection; index [t][e].
  struct Block {
    int steps = 0, envs = 0;
    std::vector<float> observations, states, actions, rewards;
    std::vector<float> own_rewards;  ///< [T, E, agents], or nothing
    /// [T, E]: row of the last observations and states of the segment that ends here, or -1.
    std::vector<std::int64_t> end;
    std::vector<float> end_observations, end_states;
  };
  using Chunk = std::vector<Block>;  // by shard

  /// Everything of a block that is no `end`.
  static std::vector<std::vector<float>*> Numbers(Block* block);

  void Resize(Block* block, int steps, int envs) const;

  const int agents_, observation_row_, state_row_, action_row_;
  const std::int64_t capacity_;
  const int n_step_;
  const int own_row_;          // rewards kept of each AUV: their number, or 0
  std::vector<float> powers_;  // gamma^k, k = 0 .. n_step
  std::vector<Chunk> chunks_;  // a ring
  std::size_t newest_ = 0;
  std::vector<std::int64_t> first_;  // of each shard, in a chunk; then all
};

}  // namespace stg::learn

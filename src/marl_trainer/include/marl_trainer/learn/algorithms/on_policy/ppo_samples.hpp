#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/normalisers.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"

namespace stg::learn {

/// The environment steps of a collection, of all ranks, as one list of samples in the random order
/// of an epoch. Every rank draws the order of all, and has the samples that its environments made.
class PpoSamples {
 public:
  explicit PpoSamples(const Team& team) : ranks_(team.ranks), share_(team.share()) {}

  /// @param rollouts must outlive the use of this object.
  void Prepare(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales);
  /// @param epoch keys the order, with seed and collection. @param minibatch samples of one
  void Shuffle(std::uint64_t seed, std::uint32_t collection, std::uint32_t epoch, int minibatch);

  /// Samples of all ranks, and this one's.
  int size() const { return static_cast<int>(own_at_.size()); }
  int own() const { return static_cast<int>(advantages_.size()); }
  /// For each minibatch of the epoch's order, where this rank's part of each group begins, and
  /// where the last one ends: for SlicedGradient.
  const std::vector<std::vector<int>>& minibatches() const { return minibatches_; }
  /// The own sample at this place of the epoch's order.
  std::size_t at(int place) const {
    return static_cast<std::size_t>(order_[static_cast<std::size_t>(place)]);
  }
  /// Where a sample's rows are.
  const RolloutBuffer& rollout(std::size_t sample) const {
    return *rollouts_[static_cast<std::size_t>(rollout_of_[sample])];
  }
  std::size_t index(std::size_t sample) const {
    return static_cast<std::size_t>(index_of_[sample]);
  }
  /// Of mean 0 and deviation 1 over the samples.
  float advantage(std::size_t sample) const { return advantages_[sample]; }
  /// Normalised value target.
  float target(std::size_t sample) const { return targets_[sample]; }

 private:
  void Normalise();

  Communicator* ranks_;
  GroupShare share_;
  std::vector<const RolloutBuffer*> rollouts_;
  std::vector<int> rollout_of_, index_of_;  // by own sample
  std::vector<float> advantages_, targets_;
  std::vector<int> own_at_;  // own sample at a place of the samples of all; -1: not own
  std::vector<int> order_;   // of the own samples
  std::vector<std::vector<int>> minibatches_;
};

}  // namespace stg::learn

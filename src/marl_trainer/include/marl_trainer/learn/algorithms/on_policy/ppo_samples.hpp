#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/normalisers.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"
#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {

/// The environment steps of all rollouts of a collection as one list of samples, in the random
/// order of an epoch. Among several ranks the list is that of all ranks, and this one has the part
/// of it that its environments made.
class PpoSamples {
 public:
  /// @param rollouts must outlive the use of this object.
  void Prepare(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales);
  /// @param ranks must outlive this object.
  void Join(Communicator* ranks) { ranks_ = ranks; }
  /// @param epoch keys the order, with seed and collection. @param minibatch samples of one
  void Shuffle(std::uint64_t seed, std::uint32_t collection, std::uint32_t epoch, int minibatch);

  /// Samples of all ranks, and this one's.
  int size() const { return size_; }
  int own() const { return static_cast<int>(advantages_.size()); }
  /// The own places, in order, of the slices of the minibatch that begins at sample `first` of all:
  /// for SlicedGradient.
  std::vector<int> Slices(int first) const;
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
  void Normalise(const std::vector<float>& all);
  std::vector<float> OfAllRanks();
  void KeepOwn();

  std::vector<const RolloutBuffer*> rollouts_;
  std::vector<int> order_, rollout_of_, index_of_;
  std::vector<float> advantages_, targets_;
  int size_ = 0, minibatch_ = 1;
  // Among several ranks.
  Communicator* ranks_ = nullptr;
  GroupShare share_;
  std::vector<int> own_at_;  // own sample at a place of the samples of all; -1: not own
  std::vector<std::vector<int>> slices_;  // by minibatch: own places
};

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/normalisers.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"

namespace stg::learn {

/// The environment steps of a collection of all ranks: one list of samples in the random order of
/// an epoch. Every rank draws the order of all samples, and stores the samples of its own
/// environments.
class PpoSamples {
 public:
  explicit PpoSamples(const Team& team) : ranks_(team.ranks), share_(team.share()) {}

  /// @param rollouts must outlive the use of this object.
  void Prepare(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales);
  /// @param epoch keys the order, with seed and collection. @param minibatch samples per minibatch
  void Shuffle(std::uint64_t seed, std::uint32_t collection, std::uint32_t epoch, int minibatch);

  /// Number of samples of all ranks, and of this rank.
  int size() const { return static_cast<int>(own_at_.size()); }
  int own() const { return static_cast<int>(advantages_.size()); }
  /// For each minibatch of the epoch's order: where this rank's part of each group begins, and
  /// where the last part ends. SlicedGradient uses it.
  const std::vector<std::vector<int>>& minibatches() const { return minibatches_; }
  /// This rank's sample at a place of the epoch's order.
  std::size_t at(int place) const {
    return static_cast<std::size_t>(order_[static_cast<std::size_t>(place)]);
  }
  /// Rollout and index of a sample's rows.
  const RolloutBuffer& rollout(std::size_t sample) const {
    return *rollouts_[static_cast<std::size_t>(rollout_of_[sample])];
  }
  std::size_t index(std::size_t sample) const {
    return static_cast<std::size_t>(index_of_[sample]);
  }
  /// Advantage, normalised to mean 0 and standard deviation 1 over the samples.
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
  // By place among the samples of all ranks: own sample; -1: of another rank.
  std::vector<int> own_at_;
  std::vector<int> order_;  // own samples, in the order of the epoch
  std::vector<std::vector<int>> minibatches_;
};

}  // namespace stg::learn

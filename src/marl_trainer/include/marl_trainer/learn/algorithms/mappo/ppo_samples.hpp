#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/mappo/normalisers.hpp"
#include "marl_trainer/learn/buffers/rollout_buffer.hpp"

namespace stg::learn {

/// The environment steps of all rollouts of a collection as one list of samples, in the random
/// order of an epoch.
class PpoSamples {
 public:
  /// @param rollouts must outlive the use of this object.
  void Prepare(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales);
  /// @param epoch keys the order, with seed and collection.
  void Shuffle(std::uint64_t seed, std::uint32_t collection, std::uint32_t epoch);

  int size() const { return static_cast<int>(advantages_.size()); }
  /// The sample at this place of the epoch's order.
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
  std::vector<const RolloutBuffer*> rollouts_;
  std::vector<int> order_, rollout_of_, index_of_;
  std::vector<float> advantages_, targets_;
};

}  // namespace stg::learn

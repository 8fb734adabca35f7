#include "marl_trainer/learn/algorithms/on_policy/ppo_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "auv_common/numbers/random.hpp"

namespace stg::learn {

void PpoSamples::Prepare(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales) {
  rollouts_ = rollouts;
  rollout_of_.clear();
  index_of_.clear();
  advantages_.clear();
  targets_.clear();
  for (std::size_t u = 0; u < rollouts.size(); ++u) {
    const RolloutBuffer& b = *rollouts[u];
    for (std::size_t i = 0; i < b.advantages.size(); ++i) {
      rollout_of_.push_back(static_cast<int>(u));
      index_of_.push_back(static_cast<int>(i));
      advantages_.push_back(b.advantages[i]);
      targets_.push_back((b.advantages[i] + b.values[i] - scales.value_mean) / scales.value_std);
    }
  }
  Normalise();
}

/// Normalises the advantages to mean 0 and standard deviation 1 over the samples of all ranks. The
/// samples are in the order of the ranks, and so in the order of their environments.
void PpoSamples::Normalise() {
  const std::vector<float> all = ranks_->Gather(advantages_);
  const std::vector<int> sizes = ranks_->Gather(std::vector<int>{own()});
  const int before = std::accumulate(sizes.begin(), sizes.begin() + ranks_->rank(), 0);
  own_at_.assign(all.size(), -1);
  std::iota(own_at_.begin() + before, own_at_.begin() + before + own(), 0);
  double sum = 0.0, squares = 0.0;
  for (const float advantage : all) {
    sum += static_cast<double>(advantage);
    squares += static_cast<double>(advantage) * static_cast<double>(advantage);
  }
  const auto n = static_cast<double>(all.size());
  const double mean = sum / n;
  const double std = std::sqrt(std::max(squares / n - mean * mean, 0.0)) + 1e-8;
  for (float& a : advantages_) a = static_cast<float>((static_cast<double>(a) - mean) / std);
}

void PpoSamples::Shuffle(std::uint64_t seed, std::uint32_t collection, std::uint32_t epoch,
                         int minibatch) {
  std::vector<int> all(own_at_.size());
  std::iota(all.begin(), all.end(), 0);
  Random random(seed, Stream::kShuffle, collection, epoch, 0);
  for (std::size_t i = all.size() - 1; i > 0; --i) {
    const auto j = static_cast<std::size_t>(random.Uniform() * static_cast<double>(i + 1));
    std::swap(all[i], all[j]);
  }
  // Takes this rank's samples from the order of all; in a minibatch they are sorted by groups.
  order_.clear();
  minibatches_.clear();
  std::vector<std::vector<int>> groups(static_cast<std::size_t>(share_.count));
  for (auto from = all.begin(); from != all.end(); from += minibatch) {
    for (std::vector<int>& group : groups) group.clear();
    std::for_each(from, from + minibatch, [&](int place) {
      const int sample = own_at_[static_cast<std::size_t>(place)];
      if (sample < 0) return;
      const int group = rollout(static_cast<std::size_t>(sample)).shard.group - share_.first;
      groups[static_cast<std::size_t>(group)].push_back(sample);
    });
    std::vector<int>& begins = minibatches_.emplace_back(1, static_cast<int>(order_.size()));
    for (const std::vector<int>& group : groups) {
      order_.insert(order_.end(), group.begin(), group.end());
      begins.push_back(static_cast<int>(order_.size()));
    }
  }
}

}  // namespace stg::learn

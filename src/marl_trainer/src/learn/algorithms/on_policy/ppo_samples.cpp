#include "marl_trainer/learn/algorithms/on_policy/ppo_samples.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/sliced_gradient.hpp"

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
  Normalise(ranks_ == nullptr ? advantages_ : OfAllRanks());
}

/// The advantages in the order that a process alone has them in; finds the own ones among them.
std::vector<float> PpoSamples::OfAllRanks() {
  share_ = GroupShare::Of(*ranks_, SlicedGradient::kSlices);
  std::vector<int> places;
  for (const RolloutBuffer* rollout : rollouts_) {
    const Shard& s = rollout->shard;
    for (int t = 0; t < rollout->steps; ++t) {
      for (int e = 0; e < rollout->envs; ++e) {
        places.push_back(rollout->steps * s.home_first + t * s.home_envs + s.first_env -
                         s.home_first + e);
      }
    }
  }
  const std::vector<float> gathered = ranks_->Gather(advantages_);
  const std::vector<int> places_of_all = ranks_->Gather(places);
  std::vector<float> all(gathered.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[static_cast<std::size_t>(places_of_all[i])] = gathered[i];
  }
  own_at_.assign(all.size(), -1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    own_at_[static_cast<std::size_t>(places[i])] = static_cast<int>(i);
  }
  return all;
}

/// To mean 0 and deviation 1 of the samples of all ranks.
void PpoSamples::Normalise(const std::vector<float>& all) {
  size_ = static_cast<int>(all.size());
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
  minibatch_ = minibatch;
  order_.resize(static_cast<std::size_t>(size_));
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<int>(i);
  Random random(seed, Stream::kShuffle, collection, epoch, 0);
  for (std::size_t i = order_.size() - 1; i > 0; --i) {
    const auto j = static_cast<std::size_t>(random.Uniform() * static_cast<double>(i + 1));
    std::swap(order_[i], order_[j]);
  }
  if (ranks_ != nullptr) KeepOwn();
}

/// Of the order of all samples keeps the own ones, those of a minibatch by their groups.
void PpoSamples::KeepOwn() {
  const std::vector<int> all = std::move(order_);
  order_.clear();
  slices_.clear();
  std::vector<std::vector<int>> groups(static_cast<std::size_t>(share_.count));
  for (std::size_t begin = 0; begin < all.size(); begin += static_cast<std::size_t>(minibatch_)) {
    for (std::vector<int>& group : groups) group.clear();
    for (std::size_t k = begin; k < begin + static_cast<std::size_t>(minibatch_); ++k) {
      const int sample = own_at_[static_cast<std::size_t>(all[k])];
      if (sample < 0) continue;
      const int group = rollout(static_cast<std::size_t>(sample)).shard.group - share_.first;
      groups[static_cast<std::size_t>(group)].push_back(sample);
    }
    std::vector<int> places{static_cast<int>(order_.size())};
    for (const std::vector<int>& group : groups) {
      order_.insert(order_.end(), group.begin(), group.end());
      places.push_back(static_cast<int>(order_.size()));
    }
    slices_.push_back(std::move(places));
  }
}

std::vector<int> PpoSamples::Slices(int first) const {
  if (ranks_ == nullptr) return SlicedGradient::EqualSlices(first, minibatch_);
  return slices_[static_cast<std::size_t>(first / minibatch_)];
}

}  // namespace stg::learn

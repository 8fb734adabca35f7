#include "marl_trainer/learn/algorithms/mappo/ppo_samples.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "auv_common/numbers/random.hpp"

namespace stg::learn {

void PpoSamples::Prepare(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales) {
  rollouts_ = rollouts;
  rollout_of_.clear();
  index_of_.clear();
  advantages_.clear();
  targets_.clear();
  double sum = 0.0, squares = 0.0;
  for (std::size_t u = 0; u < rollouts.size(); ++u) {
    const RolloutBuffer& b = *rollouts[u];
    for (std::size_t i = 0; i < b.advantages.size(); ++i) {
      const float advantage = b.advantages[i];
      const float target = advantage + b.values[i];
      rollout_of_.push_back(static_cast<int>(u));
      index_of_.push_back(static_cast<int>(i));
      advantages_.push_back(advantage);
      targets_.push_back((target - scales.value_mean) / scales.value_std);
      sum += static_cast<double>(advantage);
      squares += static_cast<double>(advantage) * static_cast<double>(advantage);
    }
  }
  const auto n = static_cast<double>(advantages_.size());
  const double mean = sum / n;
  const double std = std::sqrt(std::max(squares / n - mean * mean, 0.0)) + 1e-8;
  for (float& a : advantages_) a = static_cast<float>((static_cast<double>(a) - mean) / std);
}

void PpoSamples::Shuffle(std::uint64_t seed, std::uint32_t collection, std::uint32_t epoch) {
  order_.resize(advantages_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<int>(i);
  Random random(seed, Stream::kShuffle, collection, epoch, 0);
  for (std::size_t i = order_.size() - 1; i > 0; --i) {
    const auto j = static_cast<std::size_t>(random.Uniform() * static_cast<double>(i + 1));
    std::swap(order_[i], order_[j]);
  }
}

}  // namespace stg::learn

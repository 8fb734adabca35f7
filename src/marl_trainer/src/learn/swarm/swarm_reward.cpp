#include "marl_trainer/learn/swarm/swarm_reward.hpp"

#include <algorithm>

namespace stg::learn {
namespace {

constexpr double kEnough = 2.0;  ///< enough AUVs in the band of a target: two ranges locate it

}  // namespace

double ShareOfBand(bool chosen, int inside) {
  return chosen ? std::min(1.0, kEnough / inside) : 1.0;
}

double ShareCovered(const std::vector<int>& inside) {
  double sum = 0.0;
  for (const int count : inside) sum += std::min(1.0, count / kEnough);
  return sum / static_cast<double>(inside.size());
}

SwarmReward::SwarmReward(const SwarmConfig& config, const task::JudgeConfig& scenario)
    : agents_(scenario.run.agents),
      targets_count_(scenario.world.target.count),
      free_(scenario.agent.task.free()),
      band_m_(scenario.reward.band_m),
      targets_(scenario.world.target),
      band_(config.band),
      shaping_(config.shaping),
      own_share_(static_cast<float>(config.own_reward)),
      gamma_(static_cast<float>(config.gamma)) {}

void SwarmReward::Add(const Outcome* outcomes, float* sums) const {
  std::vector<int> inside(static_cast<std::size_t>(targets_count_));
  const auto is_inside = [&](int i) {
    const double distance = outcomes[i].distance_m;
    return outcomes[i].present && distance >= band_m_.lo && distance <= band_m_.hi;
  };
  for (int i = 0; i < agents_; ++i) {
    if (is_inside(i)) ++inside[static_cast<std::size_t>(outcomes[i].followed)];
  }
  const double covered = free_ ? ShareCovered(inside) : 0.0;
  for (int i = 0; i < agents_; ++i) {
    sums[i] += outcomes[i].reward + static_cast<float>(band_ * covered);
    if (!is_inside(i)) continue;
    const int count = inside[static_cast<std::size_t>(outcomes[i].followed)];
    sums[i] += static_cast<float>(band_ * ShareOfBand(free_, count));
  }
}

double SwarmReward::Potential(const Outcome& outcome) const {
  return -shaping_ * outcome.error_m / 100.0;
}

bool SwarmReward::SameTeam(int i, int j) const { return free_ || targets_.of(j) == targets_.of(i); }

void SwarmReward::Share(const float* own, const std::uint8_t* absent, const float* before,
                        const float* after, float* rewards) const {
  for (int i = 0; i < agents_; ++i) {
    float sum = 0.0F;
    int mates = 0;
    for (int j = 0; j < agents_; ++j) {
      if (j != i && (absent[j] != 0 || !SameTeam(i, j))) continue;
      sum += own[j];
      ++mates;
    }
    rewards[i] = own_share_ * own[i] + (1.0F - own_share_) * sum / static_cast<float>(mates) +
                 gamma_ * after[i] - before[i];
  }
}

const std::vector<std::string>& SwarmRewardKeys() {
  static const std::vector<std::string> keys = {
      "reward.error_max_m=40.0",
      "reward.w_band=1.0",
      "reward.w_progress=0.0",
      "reward.w_closing=0.0",
      "reward.w_reacquire=0.0",
      "reward.w_too_close=2.0",
      "reward.weights.semantic=0.3",
      "reward.weights.control_cost=0.0",
      "reward.weights.separation=1.5",
      "reward.separation_distance_m=40.0",
      "reward.terms.estimate.weight=0.2",
      "reward.terms.spread.weight=0.5",
      "reward.total_limit=10.0",
  };
  return keys;
}

}  // namespace stg::learn

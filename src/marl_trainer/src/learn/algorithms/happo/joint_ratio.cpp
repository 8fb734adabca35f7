#include "marl_trainer/learn/algorithms/happo/joint_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

constexpr int kFactorRows = 256;  // samples per pass through the network

}  // namespace

JointRatio::JointRatio(const ActorCritic& networks, const Team& team)
    : networks_(networks), team_(team) {
  const auto inputs = static_cast<std::size_t>(kFactorRows * networks.actor.inputs());
  scratch_.assign(static_cast<std::size_t>(team.pool->workers()),
                  {Mlp::Workspace(networks.actor.mean(), kFactorRows), std::vector<float>(inputs)});
}

void JointRatio::Begin(const std::vector<const RolloutBuffer*>& rollouts) {
  rollouts_ = rollouts;
  std::size_t samples = 0;
  for (const RolloutBuffer* b : rollouts) samples += static_cast<std::size_t>(b->samples());
  factors_.assign(samples, 1.0);
  blocks_.clear();
  double* factors = factors_.data();
  for (const RolloutBuffer* b : rollouts) {
    for (int from = 0; from < b->samples(); from += kFactorRows) {
      blocks_.push_back({b, from, std::min(b->samples(), from + kFactorRows), factors + from});
    }
    factors += b->samples();
  }
}

void JointRatio::Multiply(int auv, const Trained& actor) {
  team_.pool->Run(static_cast<int>(blocks_.size()), [&](int k, int worker) {
    MultiplyBlock(blocks_[static_cast<std::size_t>(k)], auv, actor.numbers.data(),
                  &scratch_[static_cast<std::size_t>(worker)]);
  });
}

void JointRatio::MultiplyBlock(const Block& block, int auv, const float* actor, Scratch* s) {
  const RolloutBuffer& b = *block.rollout;
  const auto inputs = static_cast<std::size_t>(networks_.actor.inputs());
  const int rows = block.to - block.from, size = networks_.action_size();
  const auto row = [&](int i) {
    return static_cast<std::size_t>((block.from + i) * b.agents + auv);
  };
  for (int i = 0; i < rows; ++i) {
    std::copy_n(b.observations.data() + row(i) * inputs, inputs,
                s->observations.data() + static_cast<std::size_t>(i) * inputs);
  }
  networks_.actor.mean().Forward(actor, s->observations.data(), rows, &s->pass);
  const float* log_std = actor + networks_.actor.log_std_offset();
  for (int i = 0; i < rows; ++i) {
    const float* action = b.actions.data() + row(i) * static_cast<std::size_t>(size);
    const double now =
        agent::GaussianLogDensity(s->pass.output() + i * size, log_std, action, size);
    block.factors[i] *= std::exp(now - static_cast<double>(b.log_prob[row(i)]));
  }
}

/// Sums each rollout separately, so the result does not depend on the ranks that have the rollouts.
double JointRatio::Miss() const {
  std::vector<double> sums;
  auto factor = factors_.begin();
  for (const RolloutBuffer* b : rollouts_) {
    sums.push_back(std::accumulate(factor, factor + b->samples(), 0.0,
                                   [](double sum, double m) { return sum + std::abs(m - 1.0); }));
    factor += b->samples();
  }
  sums = team_.ranks->Gather(sums);
  const std::vector<std::size_t> counts =
      team_.ranks->Gather(std::vector<std::size_t>{factors_.size()});
  return std::accumulate(sums.begin(), sums.end(), 0.0) /
         static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
}

}  // namespace stg::learn

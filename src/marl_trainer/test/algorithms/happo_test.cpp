#include "marl_trainer/learn/algorithms/happo/happo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "algorithms/game.hpp"
#include "stg_agent/policy/gaussian.hpp"

/// AUVs learn one after the other. The tests check what each of them knows of the earlier ones.
namespace stg::learn {
namespace {

TEST(Happo, TheFactorIsTheRatioOfTheJointDensities) {
  Game game;
  game.agents = 3;
  game.reward = [](double x, const float* a) {
    return -std::abs(static_cast<double>(a[0] + 2.0F * a[1] - a[2]) - x);
  };
  Training training(game, GameSetup("happo"));
  training.Run(5);
  const auto& happo = dynamic_cast<Happo&>(training.algorithm());
  // The buffers hold what the networks saw and did before the update. The parameters are those
  // after it.
  const std::vector<double>& factors = happo.ratio().factors();
  const Mlp& mean = happo.networks().actor.mean();
  Mlp::Workspace workspace(mean, 1);
  std::size_t sample = 0;
  double largest = 0.0;
  for (const RolloutBuffer* b : happo.rollouts().buffers()) {
    for (int i = 0; i < b->samples(); ++i, ++sample) {
      double log_ratio = 0.0;
      for (int agent = 0; agent < game.agents; ++agent) {
        const auto row = static_cast<std::size_t>(i * game.agents + agent);
        const float* actor = happo.actors()[static_cast<std::size_t>(agent)].numbers.data();
        mean.Forward(actor, &b->observations[row], 1, &workspace);
        log_ratio += agent::GaussianLogDensity(workspace.output(),
                                               actor + happo.networks().actor.log_std_offset(),
                                               &b->actions[row], 1) -
                     static_cast<double>(b->log_prob[row]);
      }
      EXPECT_NEAR(std::log(factors[sample]), log_ratio, 1e-5);
      largest = std::max(largest, std::abs(log_ratio));
    }
  }
  ASSERT_EQ(sample, factors.size());
  EXPECT_GT(largest, 0.01);
  std::vector<int> order = happo.order();
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2}));
}

TEST(Happo, EveryAuvLearnsOnTheAdvantageTimesTheRatioOfThoseBeforeIt) {
  Game game;
  game.agents = 3;
  game.reward = [](double x, const float* a) {
    return -std::abs(static_cast<double>(a[0] + 2.0F * a[1] - a[2]) - x);
  };
  // There is one step for each AUV, so that Adam's moments show the gradient.
  Training training(
      game,
      GameSetup(
          "happo",
          {{"minibatch", 192}, {"epochs", 1}, {"lr", 0.03}, {"entropy", 0.0}, {"grad-clip", 1e6}}));
  const auto& happo = dynamic_cast<Happo&>(training.algorithm());
  const Mlp& mean = happo.networks().actor.mean();
  const std::size_t spread = happo.networks().actor.log_std_offset();
  std::set<std::vector<int>> orders;
  for (int c = 0; c < 40; ++c) {
    const std::vector<Trained> before = happo.actors();
    training.Run(1);
    orders.insert(happo.order());
    if (c >= 4) continue;
    std::vector<double> weights;  // the advantage times M
    for (const RolloutBuffer* b : happo.rollouts().buffers()) {
      weights.insert(weights.end(), b->advantages.begin(), b->advantages.end());
    }
    const auto n = static_cast<double>(weights.size());
    double sum = 0.0, squares = 0.0;
    for (const double a : weights) sum += a / n;
    for (const double a : weights) squares += (a - sum) * (a - sum) / n;
    for (double& a : weights) a = (a - sum) / std::sqrt(squares);
    for (const int agent : happo.order()) {
      const auto i = static_cast<std::size_t>(agent);
      const float* old = before[i].numbers.data();
      const float* now = happo.actors()[i].numbers.data();
      Mlp::Workspace workspace(mean, 1);
      // The gradient of -weight log pi in log sigma is weight (1 - z^2), as a mean over samples.
      double gradient = 0.0;
      std::size_t sample = 0;
      for (const RolloutBuffer* b : happo.rollouts().buffers()) {
        for (int s = 0; s < b->samples(); ++s, ++sample) {
          const auto row = static_cast<std::size_t>(s * game.agents + agent);
          mean.Forward(old, &b->observations[row], 1, &workspace);
          const auto z = static_cast<double>((b->actions[row] - workspace.output()[0]) *
                                             std::exp(-old[spread]));
          gradient += weights[sample] * (1.0 - z * z) / n;
          mean.Forward(now, &b->observations[row], 1, &workspace);
          weights[sample] *= std::exp(
              agent::GaussianLogDensity(workspace.output(), now + spread, &b->actions[row], 1) -
              static_cast<double>(b->log_prob[row]));
        }
      }
      const float remembered =
          happo.actors()[i].adam.first[spread] - 0.9F * before[i].adam.first[spread];
      EXPECT_NEAR(10.0F * remembered, gradient, 1e-4) << "AUV " << agent << " of update " << c;
    }
  }
  EXPECT_EQ(orders.size(), 6U);  // all orders have come
}

TEST(Happo, SmallStepsDoNotCostReturn) {
  Game game;
  game.reward = [](double, const float* a) {
    constexpr double kPayoff[3][3] = {{3, 0, 1}, {0, 2, 4}, {1, 4, 8}};
    return kPayoff[Third(a[0])][Third(a[1])];
  };
  Training training(game, GameSetup("happo", {{"lr", 5e-4}, {"critic-lr", 3e-3}}));
  double before = training.Run(10);
  const double start = before;
  for (int part = 0; part < 5; ++part) {
    double after = 0.0;
    for (int c = 0; c < 10; ++c) after += training.Run(1) / 10.0;
    EXPECT_GT(after, before - 0.1 - (part == 0 ? 0.5 : 0.0));  // one collection is noisy
    before = after;
  }
  EXPECT_GT(before, start + 0.5);
}

}  // namespace
}  // namespace stg::learn

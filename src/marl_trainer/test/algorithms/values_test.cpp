#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/game.hpp"
#include "marl_trainer/learn/algorithms/happo/happo.hpp"
#include "marl_trainer/learn/algorithms/mappo/mappo.hpp"
#include "stg_agent/policy/gaussian.hpp"

/// What critics learn, against closed forms.
namespace stg::learn {
namespace {

/// Reward 1 for ever: worth 1 / (1 - gamma), although every episode ends after five steps.
Game ConstantGame() {
  Game game;
  game.reward = [](double, const float*) { return 1.0; };
  return game;
}

class Endless : public ::testing::TestWithParam<std::string> {};

TEST_P(Endless, TruncationIsNoEnd) {
  Training training(ConstantGame(), GameSetup(GetParam(), {{"gamma", 0.9}}));
  training.Run(150);
  EXPECT_NEAR(training.Reported("value"), 10.0, 0.1);
}

INSTANTIATE_TEST_SUITE_P(OffPolicy, Endless, ::testing::Values("maddpg", "matd3", "madqn"));

TEST(Endless, TruncationIsNoEndForSoftValues) {
  // With hardly any weight on the entropy.
  Training training(
      ConstantGame(),
      GameSetup("masac", {{"gamma", 0.9}, {"initial-alpha", 1e-6}, {"alpha-lr", 0.0}}));
  training.Run(150);
  EXPECT_NEAR(training.Reported("value"), 10.0, 0.1);
}

TEST(Masac, TheWeightDrivesTheEntropyToItsTarget) {
  Game game;  // the better the closer to x: without the bonus the entropy would fall for ever
  game.reward = [](double x, const float* a) {
    return -std::pow(static_cast<double>(a[0]) - 0.5 * x, 2.0) -
           std::pow(static_cast<double>(a[1]) - 0.5 * x, 2.0);
  };
  for (const auto& [alpha, target] : {std::pair(1e-3, -0.5), std::pair(0.1, -1.5)}) {
    Training training(game, GameSetup("masac", {{"initial-alpha", alpha},
                                                {"alpha-lr", 0.01},
                                                {"target-entropy", target}}));
    training.Run(300);
    double entropy = 0.0;
    for (int c = 0; c < 30; ++c) {
      training.Run(1);
      entropy += training.Reported("entropy") / 30.0;
    }
    EXPECT_NEAR(entropy, target, 0.15) << alpha;
  }
}

TEST(Masac, WithoutTheWeightTheEntropyMissesTheTarget) {
  Game game;
  game.reward = [](double, const float* a) { return -static_cast<double>(a[0] * a[0]); };
  Training training(
      game,
      GameSetup("masac", {{"initial-alpha", 1e-6}, {"alpha-lr", 0.0}, {"target-entropy", -1.0}}));
  training.Run(200);
  EXPECT_GT(std::abs(training.Reported("entropy") + 1.0), 0.3);
}

double Value(const Mlp& critic, const float* parameters, const Scales& scales, float x) {
  float state = 0.0F;
  scales.states.Apply(&x, 1, &state);
  Mlp::Workspace workspace(critic, 1);
  critic.Forward(parameters, &state, 1, &workspace);
  return static_cast<double>(scales.value_mean + scales.value_std * workspace.output()[0]);
}

TEST(Endless, TruncationIsNoEndForAnOnPolicyCritic) {
  Training mappo(ConstantGame(), GameSetup("mappo", {{"gamma", 0.9}}));
  Training happo(ConstantGame(), GameSetup("happo", {{"gamma", 0.9}}));
  mappo.Run(150);
  happo.Run(150);
  const auto& m = dynamic_cast<Mappo&>(mappo.algorithm());
  const auto& h = dynamic_cast<Happo&>(happo.algorithm());
  for (const float x : {-0.8F, 0.0F, 0.5F}) {
    EXPECT_NEAR(Value(m.networks().critic, m.parameters().data() + m.networks().critic_offset(),
                      m.scales(), x),
                10.0, 0.2);
    EXPECT_NEAR(Value(h.networks().critic, h.parameters().critic.data(), h.rollouts().scales(), x),
                10.0, 0.2);
  }
}

TEST(Happo, TheFactorIsTheRatioOfTheJointDensities) {
  Game game;
  game.agents = 3;
  game.reward = [](double x, const float* a) {
    return -std::abs(static_cast<double>(a[0] + 2.0F * a[1] - a[2]) - x);
  };
  Training training(game, GameSetup("happo"));
  training.Run(5);
  const auto& happo = dynamic_cast<Happo&>(training.algorithm());
  // The buffers hold what the networks saw and did; the parameters are those after the update.
  const std::vector<double>& factors = happo.update().factors();
  const Mlp& mean = happo.networks().actor.mean();
  Mlp::Workspace workspace(mean, 1);
  std::size_t sample = 0;
  double largest = 0.0;
  for (const RolloutBuffer* b : happo.rollouts().buffers()) {
    for (int i = 0; i < b->samples(); ++i, ++sample) {
      double log_ratio = 0.0;
      for (int agent = 0; agent < game.agents; ++agent) {
        const auto row = static_cast<std::size_t>(i * game.agents + agent);
        const float* actor = happo.parameters().actors[static_cast<std::size_t>(agent)].data();
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
  std::vector<int> order = happo.update().order();
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2}));
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

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "algorithms/game.hpp"
#include "learn/draw.hpp"
#include "marl_trainer/learn/algorithms/happo/happo.hpp"
#include "marl_trainer/learn/algorithms/madqn/madqn.hpp"
#include "marl_trainer/learn/algorithms/mappo/mappo.hpp"
#include "marl_trainer/learn/algorithms/off_policy/central_critic_learner.hpp"

/// Compares what critics learn with closed forms.
namespace stg::learn {
namespace {

/// The reward is 1 for ever, so the value is 1 / (1 - gamma), although every episode ends after
/// five steps.
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
  // The entropy has almost no weight.
  Training training(
      ConstantGame(),
      GameSetup("masac", {{"gamma", 0.9}, {"initial-alpha", 1e-6}, {"alpha-lr", 0.0}}));
  training.Run(150);
  EXPECT_NEAR(training.Reported("value"), 10.0, 0.1);
}

TEST(Masac, TheWeightDrivesTheEntropyToItsTarget) {
  Game game;  // without the bonus for entropy, the entropy would fall for ever
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
    EXPECT_NEAR(Value(m.networks().critic, m.critic().numbers.data(), m.scales(), x), 10.0, 0.2);
    EXPECT_NEAR(Value(h.networks().critic, h.critic().numbers.data(), h.rollouts().scales(), x),
                10.0, 0.2);
  }
}

/// The reward is 1 at x = 1 and 0 at x = -1. These two take turns, whatever the agents do: V(1) = 1
/// / (1 - gamma^2) and V(-1) = gamma V(1). An episode of five steps begins at x = 1, and its final
/// state is x = -1. Only the state that follows gives these values; before a restart this is the
/// final state.
Game TakingTurns() {
  Game game;
  game.path = [](int step) { return step % 2 == 0 ? 1.0 : -1.0; };
  game.reward = [](double x, const float*) { return x > 0.0 ? 1.0 : 0.0; };
  return game;
}

/// The values of the networks and of their targets, in units of reward. If the outputs are a value
/// and advantages of bins, these are the values of all actions.
std::vector<double> ReplayedValues(Training* training, const std::vector<float>& inputs) {
  const auto& learner = dynamic_cast<const ReplayLearner&>(training->algorithm());
  const auto* q = dynamic_cast<const Madqn*>(&learner);
  const Mlp& network = q != nullptr
                           ? q->network()
                           : dynamic_cast<const CentralCriticLearner&>(learner).critics().network();
  const Archive archive = training->Save();
  Mlp::Workspace workspace(network, 1);
  std::vector<double> values;
  for (const std::string target : {"", "target_"}) {
    const std::vector<float>& all = archive.Floats(target + (q != nullptr ? "network" : "critics"));
    for (std::size_t from = 0; from < all.size(); from += network.parameters()) {
      network.Forward(all.data() + from, inputs.data(), 1, &workspace);
      const float* out = workspace.output();
      float mean = 0.0F;
      for (int k = 1; k < network.outputs(); ++k) mean += out[k] / (network.outputs() - 1);
      for (int k = std::min(1, network.outputs() - 1); k < network.outputs(); ++k) {
        const float value = network.outputs() == 1 ? out[0] : out[0] + out[k] - mean;
        values.push_back(
            static_cast<double>(learner.scales().value_mean + learner.scales().reward_std * value));
      }
    }
  }
  return values;
}

/// Options for values in which the entropy of MASAC has almost no weight.
nlohmann::json PlainValues(const std::string& algorithm, nlohmann::json options) {
  if (algorithm == "masac") options.update({{"initial-alpha", 1e-6}, {"alpha-lr", 0.0}});
  return options;
}

class Replayed : public ::testing::TestWithParam<std::string> {};

TEST_P(Replayed, ValuesAreThoseOfTheStateThatFollows) {
  constexpr double kGamma = 0.7;
  for (const int n : {1, 3}) {
    const nlohmann::json options =
        PlainValues(GetParam(), {{"gamma", kGamma}, {"n-step", n}, {"tau", 0.05}});
    Training training(TakingTurns(), GameSetup(GetParam(), options));
    training.Run(100);
    const auto& scales = dynamic_cast<const ReplayLearner&>(training.algorithm()).scales();
    for (const float x : {1.0F, -1.0F}) {
      float seen = 0.0F;
      (GetParam() == "madqn" ? scales.observations : scales.states).Apply(&x, 1, &seen);
      const double expected = (x > 0.0F ? 1.0 : kGamma) / (1.0 - kGamma * kGamma);
      // The other inputs of a critic are actions of zero.
      for (const double value : ReplayedValues(&training, {seen, 0.0F, 0.0F})) {
        EXPECT_NEAR(value, expected, 0.1) << x << " of " << n << " steps";
      }
    }
  }
}

TEST_P(Replayed, ValuesStayWhenTheScaleOfRewardsChanges) {
  Game game;
  game.reward = [](double x, const float*) { return 10.0 + 3.0 * x; };
  Training training(game, GameSetup(GetParam(), {{"replayed", 0.0}}));
  training.Run(1);
  const std::vector<float> inputs = Draw(3, 1.0F, 1);
  const ReplayScales before = dynamic_cast<ReplayLearner&>(training.algorithm()).scales();
  const std::vector<double> values = ReplayedValues(&training, inputs);
  training.Run(1);
  const ReplayScales& after = dynamic_cast<ReplayLearner&>(training.algorithm()).scales();
  EXPECT_GT(std::abs(after.value_mean - before.value_mean), 0.1F);
  EXPECT_GT(std::abs(after.reward_std - before.reward_std), 0.01F);
  const std::vector<double> now = ReplayedValues(&training, inputs);
  for (std::size_t i = 0; i < now.size(); ++i) EXPECT_NEAR(now[i], values[i], 1e-4) << i;
}

INSTANTIATE_TEST_SUITE_P(OffPolicy, Replayed,
                         ::testing::Values("maddpg", "matd3", "masac", "madqn"));

TEST(TakingTurns, AnOnPolicyCriticKnowsTheStateThatFollows) {
  constexpr double kGamma = 0.7;
  Training mappo(TakingTurns(), GameSetup("mappo", {{"gamma", kGamma}}));
  mappo.Run(150);
  const auto& m = dynamic_cast<Mappo&>(mappo.algorithm());
  for (const float x : {1.0F, -1.0F}) {
    EXPECT_NEAR(Value(m.networks().critic, m.critic().numbers.data(), m.scales(), x),
                (x > 0.0F ? 1.0 : kGamma) / (1.0 - kGamma * kGamma), 0.05);
  }
}

TEST(Normalisers, ValuesStayWhenTheirScaleChanges) {
  const MappoConfig config;
  const ActorCritic networks(Problem(), config);
  Normalisers normalisers(Problem(), config);
  std::vector<float> critic = Draw(networks.critic.parameters(), 0.3F, 1);
  const auto add = [&](float mean, float deviation) {
    RunningMoments targets(1);
    std::vector<float> numbers = Draw(1000, deviation, 2);
    for (float& x : numbers) x += mean;
    targets.Add(numbers.data(), 1000);
    normalisers.AddTargets(targets, networks.critic, critic.data());
  };
  add(3.0F, 2.0F);
  const double before = Value(networks.critic, critic.data(), normalisers.scales(), 0.4F);
  add(20.0F, 7.0F);
  EXPECT_NEAR(normalisers.scales().value_mean, 11.5, 0.5);
  EXPECT_GT(normalisers.scales().value_std, 8.0F);
  EXPECT_NEAR(Value(networks.critic, critic.data(), normalisers.scales(), 0.4F), before, 1e-3);
}

}  // namespace
}  // namespace stg::learn

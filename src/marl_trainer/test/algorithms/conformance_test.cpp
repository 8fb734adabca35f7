#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "algorithms/game.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/algorithm_config.hpp"

/// What every registered algorithm promises, whatever it learns.
namespace stg::learn {
namespace {

Game AnyGame() {
  Game game;
  game.agents = 3;
  game.scale = 0.75;
  game.reward = [](double x, const float* a) {
    return 1.0 - std::abs(x - static_cast<double>(a[0])) -
           std::abs(static_cast<double>(a[1] - a[2]));
  };
  return game;
}

class Conformance : public ::testing::TestWithParam<std::string> {};

TEST_P(Conformance, DoesNotDependOnTheNumberOfWorkers) {
  const TrainSetup setup = GameSetup(GetParam());
  Training one(AnyGame(), setup, 1), three(AnyGame(), setup, 3);
  one.Run(12);
  three.Run(12);
  EXPECT_TRUE(one.Save() == three.Save());
  TrainSetup other = setup;
  other.common.seed = 1;
  Training seeded(AnyGame(), other);
  seeded.Run(12);
  EXPECT_FALSE(seeded.Save() == one.Save());
}

TEST_P(Conformance, ResumesBitForBit) {
  const TrainSetup setup = GameSetup(GetParam());
  Training whole(AnyGame(), setup), first(AnyGame(), setup), second(AnyGame(), setup);
  whole.Run(14);
  first.Run(8);
  second.Load(first.Save());
  EXPECT_TRUE(second.Save() == first.Save());
  second.ContinueAt(8);
  second.Run(6);
  EXPECT_TRUE(second.Save() == whole.Save());
}

TEST_P(Conformance, RefusesTheCheckpointOfAnotherShape) {
  Training training(AnyGame(), GameSetup(GetParam()));
  training.Run(1);
  Game larger = AnyGame();
  Training other(larger, GameSetup(GetParam(), {{"actor-hidden", {8}}}));
  EXPECT_THROW(other.Load(training.Save()), std::exception);
}

TEST_P(Conformance, ExportsThePolicyThatItFlies) {
  const Game game = AnyGame();
  Training training(game, GameSetup(GetParam()));
  training.Run(40);
  agent::PolicyMetadata metadata;
  metadata.observation_layout = "any";
  metadata.action_interface = "any";
  const std::vector<agent::Policy> policies = training.algorithm().Policies(metadata);
  ASSERT_TRUE(policies.size() == 1 || policies.size() == static_cast<std::size_t>(game.agents));
  bool moves = false;
  for (const float x : {-2.0F, -0.5F, 0.1F, 0.7F}) {
    const std::vector<float> flown = training.Act(static_cast<double>(x));
    for (std::size_t i = 0; i < flown.size(); ++i) {
      float action = 0.0F;
      policies[policies.size() == 1 ? 0 : i].Mean(&x, &action);
      EXPECT_NEAR(action, flown[i], 1e-6) << x;
      moves = moves || flown[i] != 0.0F;
    }
  }
  EXPECT_TRUE(moves);
}

/// Numbers of a network with two hidden layers of h: weights and biases.
std::size_t Numbers(std::size_t inputs, std::size_t h, std::size_t outputs) {
  return (inputs + 1) * h + (h + 1) * h + (h + 1) * outputs;
}

TEST_P(Conformance, TellsTheSizesOfWhatItTrains) {
  const std::string name = GetParam();
  // An observation, a state and an action are one number each; actor-hidden and critic-hidden are
  // GameSetup's. A Gaussian actor has its spread beside the network.
  constexpr std::size_t kAgents = 3, kBins = 5;
  const std::size_t gaussian = Numbers(1, 16, 1) + 1, joint = Numbers(1 + kAgents, 32, 1);
  const std::map<std::string, std::map<std::string, std::size_t>> expected = {
      {"mappo", {{"actor", gaussian}, {"critic", Numbers(1, 32, 1)}}},
      {"ippo", {{"actor", gaussian}, {"critic", Numbers(1, 32, 1)}}},
      {"happo",
       {{"actor_0", gaussian},
        {"actor_1", gaussian},
        {"actor_2", gaussian},
        {"critic", Numbers(1, 32, 1)}}},
      {"maddpg", {{"actor", Numbers(1, 16, 1)}, {"critic", joint}}},
      {"matd3", {{"actor", Numbers(1, 16, 1)}, {"critic_0", joint}, {"critic_1", joint}}},
      {"masac",
       {{"actor", Numbers(1, 16, 2)},
        {"critic_0", joint},
        {"critic_1", joint},
        {"entropy_weight", 1}}},
      {"madqn", {{"values", Numbers(1, 16, 1 + kBins)}}}};
  const nlohmann::json options = {{"bins", kBins}};
  Training training(AnyGame(), GameSetup(name, name == "madqn" ? options : nlohmann::json()));
  std::map<std::string, std::size_t> told;
  for (const NetworkSize& size : training.algorithm().Sizes()) told[size.name] = size.parameters;
  EXPECT_EQ(told, expected.at(name));
}

TEST_P(Conformance, PresetsAreValidAndSurviveJson) {
  for (const char* preset : {"fast", "paper"}) {
    const TrainSetup setup(GetParam(), preset);
    EXPECT_NO_THROW(setup.ValidateOrThrow()) << preset;
    EXPECT_EQ(ToJson(TrainSetupFromJson(ToJson(setup))), ToJson(setup)) << preset;
  }
  EXPECT_NE(ToJson(TrainSetup(GetParam(), "paper")), ToJson(TrainSetup(GetParam(), "fast")));
  EXPECT_THROW(TrainSetup(GetParam(), "slow"), UserError);
}

TEST_P(Conformance, ImitationIsLearntOrRefused) {
  TrainSetup setup(GetParam(), "fast");
  setup.common.imitation.controller = "pursuit";
  setup.common.imitation.steps = 1000;
  const bool on_policy = GetParam().find("ppo") != std::string::npos;
  if (on_policy) {
    EXPECT_NO_THROW(setup.ValidateOrThrow());
  } else {
    EXPECT_THROW(setup.ValidateOrThrow(), UserError);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Conformance, ::testing::ValuesIn(Algorithms().Names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace stg::learn

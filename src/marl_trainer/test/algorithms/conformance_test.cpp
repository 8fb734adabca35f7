#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "algorithms/game.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/algorithm_config.hpp"
#include "marl_trainer/learn/collect/imitation.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"

/// Properties that every registered algorithm must have, whatever it learns.
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

TEST(Export, AFileHasTheLeastSpreadWhereTheScaleMakesItSmaller) {
  Game game = AnyGame();
  agent::PolicyMetadata metadata;
  metadata.observation_layout = metadata.action_interface = "any";
  const auto spread = [&](const std::string& name, const nlohmann::json& options) {
    Training training(game, GameSetup(name, options));
    return training.algorithm().Policies(metadata).front().parameters().log_std[0];
  };
  game.scale = 0.05;  // its log is -3.0
  EXPECT_EQ(spread("masac", {{"min-log-std", -20.0}, {"max-log-std", -19.9}}), kNoSpread);
  EXPECT_NEAR(spread("masac", {{"min-log-std", -10.0}, {"max-log-std", -9.9}}), -12.95F, 0.06F);
  game.scale = 1e-8;
  EXPECT_EQ(spread("maddpg", {{"noise-min", 1e-3}}), kNoSpread);
}

/// The setup of GameSetup, but all environments explore with the same strength.
TrainSetup ExploringSetup(const std::string& name) {
  nlohmann::json options;
  for (const char* option : {"noise-min", "noise-max"}) {
    if (name == "maddpg" || name == "matd3") options[option] = 0.1;
  }
  for (const char* option : {"epsilon-min", "epsilon-max"}) {
    if (name == "madqn") options[option] = 0.5;
  }
  return GameSetup(name, options);
}

TEST_P(Conformance, EveryAuvOfEveryEnvironmentExploresOnItsOwn) {
  const Game game = AnyGame();
  constexpr int kEnvs = 12, kSteps = 20;
  const std::vector<float> seen(static_cast<std::size_t>(kEnvs * game.agents), 0.3F);
  Training training(game, ExploringSetup(GetParam()));
  for (const int collections : {1, 9}) {  // off-policy methods act at random in the first ones
    training.Run(collections);
    std::set<std::vector<float>> sequences;
    for (const int first_env : {0, kEnvs}) {
      std::vector<std::vector<float>> by_row(seen.size());
      for (std::uint32_t t = 0; t < 2 * kSteps; ++t) {
        const DrawKeys keys{0, 100 + t / kSteps, t % kSteps, first_env};
        Decision decision;
        decision.envs = kEnvs;
        decision.observations = seen.data();
        decision.explore = &keys;
        std::vector<float> actions(seen.size()), log_prob(seen.size());
        training.algorithm().Act(decision, {actions.data(), log_prob.data()});
        for (std::size_t r = 0; r < seen.size(); ++r) by_row[r].push_back(actions[r]);
      }
      // There is one sequence for each collection. No two may be the same.
      for (const std::vector<float>& row : by_row) {
        for (const auto from : {row.begin(), row.begin() + kSteps}) {
          sequences.insert({from, from + kSteps});
          EXPECT_GT(std::set<float>(from, from + kSteps).size(), 1U);
        }
      }
    }
    EXPECT_EQ(sequences.size(), 2 * 2 * seen.size());
  }
}

TEST(Exploration, GrowsByEqualFactorsFromTheFirstEnvironmentToTheLast) {
  const Game game = AnyGame();
  constexpr double kX = 0.3, kLeast = 0.04, kMost = 0.25;
  for (const std::string name : {"maddpg", "matd3", "madqn"}) {
    const bool bins = name == "madqn";
    const std::string option = bins ? "epsilon" : "noise";
    const TrainSetup setup =
        GameSetup(name, {{option + "-min", kLeast}, {option + "-max", kMost}, {"warmup", 0}});
    Training training(game, setup);
    training.Run(1);
    const std::vector<float> means = training.Act(kX), seen(means.size(), static_cast<float>(kX));
    for (const int env : {0, 8, setup.common.envs - 1}) {
      double squares = 0.0, others = 0.0;
      constexpr std::uint32_t kSteps = 4000;
      for (std::uint32_t t = 0; t < kSteps; ++t) {
        const DrawKeys keys{0, 100, t, env};
        Decision decision;
        decision.envs = 1;
        decision.observations = seen.data();
        decision.explore = &keys;
        std::vector<float> actions(seen.size());
        training.algorithm().Act(decision, {actions.data(), nullptr});
        for (std::size_t r = 0; r < actions.size(); ++r) {
          const double miss = static_cast<double>(actions[r] - means[r]) / game.scale;
          squares += miss * miss / (kSteps * static_cast<double>(actions.size()));
          others += (miss != 0.0 ? 1.0 : 0.0) / (kSteps * static_cast<double>(actions.size()));
        }
      }
      // The random one of five bins is sometimes the same bin again.
      const double found = bins ? others * 5.0 / 4.0 : std::sqrt(squares);
      const double expected = kLeast * std::pow(kMost / kLeast, env / (setup.common.envs - 1.0));
      EXPECT_NEAR(found, expected, 0.1 * expected) << name << " in environment " << env;
    }
  }
}

TEST_P(Conformance, LearningRatesFallLinearlyToTheirShareAtTheEnd) {
  const nlohmann::json was = ToJson(GameSetup(GetParam()));
  nlohmann::json less;
  for (const char* rate : {"lr", "critic-lr", "alpha-lr"}) {
    if (was.contains(rate)) less[rate] = 0.625 * was[rate].get<double>();
  }
  // This is half-way from 1 to a quarter.
  Training falling(AnyGame(), GameSetup(GetParam(), {{"lr-final", 0.25}}));
  Training lower(AnyGame(), GameSetup(GetParam(), less));
  falling.Run(12, 0.5);
  lower.Run(12);
  EXPECT_TRUE(falling.Save() == lower.Save());
  EXPECT_DOUBLE_EQ(falling.Reported("learning_rate"), less["lr"]);
  for (const double progress : {1.0, 1.1}) {  // whole collections may go past the end
    falling.Run(1, progress);
    EXPECT_DOUBLE_EQ(falling.Reported("learning_rate"), 0.25 * was["lr"].get<double>());
  }
}

/// Parameters of a network with two hidden layers of h: weights and biases.
std::size_t Numbers(std::size_t inputs, std::size_t h, std::size_t outputs) {
  return (inputs + 1) * h + (h + 1) * h + (h + 1) * outputs;
}

TEST_P(Conformance, TellsTheSizesOfWhatItTrains) {
  const std::string name = GetParam();
  // An observation, a state and an action are one number each. GameSetup gives actor-hidden and
  // critic-hidden. A Gaussian actor has its spread in addition to the network.
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
  std::map<std::string, std::size_t> sent;
  for (const NetworkSize& size : training.algorithm().Sizes()) sent[size.name] = size.parameters;
  EXPECT_EQ(sent, expected.at(name));
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
  nlohmann::ordered_json json = ToJson(setup);
  json["imitate"] = "pursuit";
  json["imitation-steps"] = 1000;
  const bool on_policy = GetParam().find("ppo") != std::string::npos;
  EXPECT_EQ(setup.own->Imitation() != nullptr, on_policy);
  if (on_policy) {
    EXPECT_EQ(TrainSetupFromJson(json).own->Imitation()->controller, "pursuit");
  } else {
    EXPECT_THROW(TrainSetupFromJson(json), UserError);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Conformance, ::testing::ValuesIn(Algorithms().Names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace stg::learn

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

#include "algorithms/game.hpp"
#include "marl_trainer/learn/algorithms/madqn/madqn.hpp"

/// Games with known optima, which an algorithm must be able to learn.
namespace stg::learn {
namespace {

Game PenaltyGame() {
  Game game;
  game.reward = [](double, const float* a) {
    constexpr double kPayoff[3][3] = {{10, 0, 0}, {0, 2, 0}, {0, 0, 10}};
    return kPayoff[Third(a[0])][Third(a[1])];
  };
  return game;
}

/// Both agents get 1 when they do different things.
Game DifferingGame() {
  Game game;
  game.reward = [](double, const float* a) { return (a[0] > 0.0F) != (a[1] > 0.0F) ? 1.0 : 0.0; };
  return game;
}

constexpr int kTeam = 3;
constexpr double kEffort = 0.5;

/// Three agents share the work of reaching x: r = -(sum a - x)^2 - rho sum a^2. The optimum is a =
/// x / (n + rho) for all, and its value is -rho x^2 / (n + rho).
Game QuadraticTeam() {
  Game game;
  game.agents = kTeam;
  game.scale = 0.75;
  game.reward = [](double x, const float* a) {
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < kTeam; ++i) {
      sum += static_cast<double>(a[i]);
      squares += static_cast<double>(a[i]) * static_cast<double>(a[i]);
    }
    return -(sum - x) * (sum - x) - kEffort * squares;
  };
  return game;
}

struct Case {
  std::string algorithm;
  nlohmann::json options;
  int collections;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.algorithm; }

class Penalty : public ::testing::TestWithParam<Case> {};

TEST_P(Penalty, ReachesTheOptimum) {
  const Game game = PenaltyGame();
  Training training(game, GameSetup(GetParam().algorithm, GetParam().options));
  training.Run(GetParam().collections);
  for (const double x : {-0.9, -0.3, 0.1, 0.8}) {
    EXPECT_EQ(game.reward(x, training.Act(x).data()), 10.0) << x;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Algorithms, Penalty,
    ::testing::Values(Case{"mappo", {}, 100}, Case{"ippo", {}, 100}, Case{"happo", {}, 100},
                      Case{"maddpg", {{"others", "buffer"}, {"noise-max", 0.5}}, 150},
                      Case{"matd3", {{"others", "buffer"}, {"noise-max", 0.5}}, 150},
                      Case{"masac", {}, 150}, Case{"madqn", {{"bins", 3}}, 150},
                      Case{"madqn", {{"heads", "joint"}}, 150}));

class Quadratic : public ::testing::TestWithParam<Case> {};

TEST_P(Quadratic, EverybodyDoesItsShare) {
  const Game game = QuadraticTeam();
  Training training(game, GameSetup(GetParam().algorithm, GetParam().options));
  training.Run(GetParam().collections);
  for (const double x : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
    const std::vector<float> actions = training.Act(x);
    for (const float a : actions) EXPECT_NEAR(a, x / (kTeam + kEffort), 0.05) << x;
    EXPECT_NEAR(game.reward(x, actions.data()), -kEffort * x * x / (kTeam + kEffort), 0.02) << x;
  }
}

INSTANTIATE_TEST_SUITE_P(Algorithms, Quadratic,
                         ::testing::Values(Case{"mappo", {}, 200}, Case{"ippo", {}, 200},
                                           Case{"happo", {}, 300},
                                           Case{"maddpg", {{"action-gain", 1.0}}, 300},
                                           Case{"matd3", {}, 300}, Case{"masac", {}, 300}));

TEST(Imitation, OnPolicyActorsDoWhatTheTeacherDoes) {
  for (const char* algorithm : {"mappo", "ippo", "happo"}) {
    // Only an algorithm with one actor per agent can tell the agents apart.
    const bool own = std::string(algorithm) == "happo";
    Game game;
    game.reward = [](double, const float*) { return 0.0; };
    game.teacher = [own](double x, int agent) { return own && agent == 1 ? -0.4 * x : 0.4 * x; };
    Training training(game, GameSetup(algorithm));
    training.Run(100);
    for (const double x : {-0.8, -0.2, 0.3, 0.9}) {
      const std::vector<float> actions = training.Act(x);
      for (int agent = 0; agent < 2; ++agent) {
        EXPECT_NEAR(actions[static_cast<std::size_t>(agent)], game.teacher(x, agent), 0.05)
            << algorithm << " at " << x;
      }
    }
  }
}

TEST(Quadratic, TheBestBinsAreChosen) {
  const Game game = QuadraticTeam();
  Training training(game, GameSetup("madqn", {{"bins", 5}}));
  training.Run(300);
  // All agents choose alike. Of -0.75, -0.375, 0, 0.375, 0.75, zero is best up to |x| = 0.66.
  for (const double x : {-0.95, -0.3, 0.0, 0.3, 0.95}) {
    const float best = std::abs(x) < 0.66 ? 0.0F : x > 0 ? 0.375F : -0.375F;
    for (const float a : training.Act(x)) EXPECT_EQ(a, best) << x;
  }
}

TEST(Codebook, ForcesAndMomentsShareTheirLevels) {
  Problem forces;
  forces.action_size = 6;
  QOptions options;
  options.heads = QHeads::kBook;
  const Codebook book(forces, options);
  ASSERT_EQ(book.heads, 1);
  ASSERT_EQ(book.count, 125);
  ASSERT_EQ(book.width, 6);
  std::set<std::vector<float>> codes;
  for (int k = 0; k < book.count; ++k) {
    const float* code = book.choices.data() + static_cast<std::ptrdiff_t>(k) * book.width;
    for (int d = 0; d < 3; ++d) EXPECT_EQ(code[d], code[d + 3]) << k;
    EXPECT_EQ(book.Nearest(0, code), k);
    codes.insert({code, code + 3});
  }
  EXPECT_EQ(codes.size(), 125U);  // each combination is there once
  // For three velocities the book has every combination.
  Problem velocities;
  velocities.action_size = 3;
  QOptions joint;
  joint.heads = QHeads::kJoint;
  EXPECT_EQ(Codebook(velocities, options).choices, Codebook(velocities, joint).choices);
}

TEST(OwnReward, IsWhatTheAgentsLearnFromWhereTheyAreTold) {
  // One agent's gain is the other's loss. The team's reward is always zero, but each agent would
  // gain most if the other did nothing.
  Game game;
  game.reward = [](double, const float*) { return 0.0; };
  game.own_reward = [](double x, const float* a, int agent) {
    return (x > 0.0 ? 1.0 : -1.0) * static_cast<double>(a[agent] - a[1 - agent]);
  };
  const auto greedy = [](const std::vector<float>& actions, float x) {
    return actions[0] == (x > 0.0F ? 1.0F : -1.0F) && actions[1] == actions[0];
  };
  Training own(game, GameSetup("madqn", {{"bins", 3}, {"reward", "own"}}));
  Training team(game, GameSetup("madqn", {{"bins", 3}, {"reward", "team"}}));
  own.Run(150);
  team.Run(150);
  int same = 0;
  for (const float x : {-0.9F, -0.5F, 0.5F, 0.9F}) {
    EXPECT_TRUE(greedy(own.Act(static_cast<double>(x)), x)) << x;
    same += greedy(team.Act(static_cast<double>(x)), x) ? 1 : 0;
  }
  EXPECT_LT(same, 4);
}

TEST(Differing, AnActorThatAllShareCannotAndActorsOfTheirOwnCan) {
  Training shared(DifferingGame(), GameSetup("mappo"));
  // Two agents that act alike differ at best half of the time, by chance.
  EXPECT_LT(shared.Run(60), 0.6);
  const std::vector<float> alike = shared.Act(0.3);
  EXPECT_EQ(alike[0], alike[1]);
  for (const bool sequential : {true, false}) {
    Training own(DifferingGame(), GameSetup("happo", {{"sequential", sequential}}));
    EXPECT_GT(own.Run(100), 0.9) << sequential;
    const std::vector<float> actions = own.Act(0.3);
    EXPECT_LT(actions[0] * actions[1], 0.0F);
  }
}

}  // namespace
}  // namespace stg::learn

#include <array>
#include <cstdio>
#include <map>
#include <string>

#include "algorithms/game.hpp"
#include "marl_trainer/learn/algorithm_config.hpp"

/// Result of each algorithm in the climbing game (Claus and Boutilier 1998) with ten seeds, for the
/// table of docs/algorithms. It is not a test: the best joint action is next to the worst payoffs,
/// and
/// independent learners are known to choose a worse one.
namespace stg::learn {
namespace {

constexpr int kSeeds = 10, kCollections = 200;
constexpr double kPayoff[3][3] = {{11, -30, 0}, {-30, 7, 6}, {0, 0, 5}};
constexpr std::array<double, 6> kValues = {11, 7, 6, 5, 0, -30};

Game ClimbingGame() {
  Game game;
  game.reward = [](double, const float* a) { return kPayoff[Third(a[0])][Third(a[1])]; };
  return game;
}

/// The same options as in the test of the penalty game.
nlohmann::json Options(const std::string& algorithm) {
  if (algorithm == "maddpg" || algorithm == "matd3") {
    return {{"others", "buffer"}, {"noise-max", 0.5}};
  }
  if (algorithm == "madqn") return {{"bins", 3}};
  return {};
}

/// Mean payoff of the final policies over a grid of observations.
double Reached(const std::string& algorithm, int seed) {
  const Game game = ClimbingGame();
  TrainSetup setup = GameSetup(algorithm, Options(algorithm));
  setup.common.seed = static_cast<std::uint64_t>(seed);
  Training training(game, setup);
  training.Run(kCollections);
  double sum = 0.0;
  constexpr int kShown = 21;
  for (int k = 0; k < kShown; ++k) {
    const double x = -1.0 + 2.0 * k / (kShown - 1);
    sum += game.reward(x, training.Act(x).data());
  }
  return sum / kShown;
}

int Main() {
  std::printf("| algorithm |");
  for (const double value : kValues) std::printf(" %.0f |", value);
  std::printf(" between | mean |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& algorithm : Algorithms().Names()) {
    std::map<double, int> ended;
    double sum = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const double reached = Reached(algorithm, seed);
      ++ended[reached];
      sum += reached;
    }
    int at_a_payoff = 0;
    std::printf("| `%s` |", algorithm.c_str());
    for (const double value : kValues) {
      const int count = ended.count(value) == 0 ? 0 : ended.at(value);
      at_a_payoff += count;
      std::printf(" %d |", count);
    }
    std::printf(" %d | %.2f |\n", kSeeds - at_a_payoff, sum / kSeeds);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace stg::learn

int main() { return stg::learn::Main(); }

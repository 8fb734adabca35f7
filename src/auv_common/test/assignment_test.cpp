#include "auv_common/numbers/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <vector>

namespace stg {
namespace {

TEST(Assignment, IsTheCheapestOfAll) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-5.0, 20.0);
  AssignmentSolver<5, 6> solver;
  for (int trial = 0; trial < 300; ++trial) {
    const int rows = 1 + trial % 5, columns = rows + trial % 2;
    std::vector<double> cost(static_cast<std::size_t>(rows * columns));
    for (double& c : cost) c = uniform(random);
    const auto at = [&](int r, int c) { return cost[static_cast<std::size_t>(r * columns + c)]; };
    double best = 1e9;
    std::vector<int> order(static_cast<std::size_t>(columns));
    std::iota(order.begin(), order.end(), 0);
    do {
      double sum = 0.0;
      for (int r = 0; r < rows; ++r) sum += at(r, order[static_cast<std::size_t>(r)]);
      best = std::min(best, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(solver.Solve(rows, columns, at), best, 1e-9);
    double sum = 0.0;
    std::array<int, 6> taken{};
    for (int r = 0; r < rows; ++r) {
      sum += at(r, solver.column_of(r));
      EXPECT_EQ(taken[static_cast<std::size_t>(solver.column_of(r))]++, 0);
    }
    EXPECT_NEAR(sum, best, 1e-9);
  }
}

TEST(Assignment, OfNobodyCostsNothing) {
  AssignmentSolver<3, 3> solver;
  EXPECT_EQ(solver.Solve(0, 3, [](int, int) { return 1.0; }), 0.0);
}

}  // namespace
}  // namespace stg

#pragma once

#include <array>
#include <cstddef>
#include <limits>

namespace stg {

/// Gives every row a column of its own at the lowest total cost, by the Hungarian method with
/// potentials (Kuhn 1955, Munkres 1957; shortest augmenting paths, Jonker and Volgenant 1987).
/// Time: at most the number of rows times the square of the number of columns. Among several
/// solutions with the lowest cost, it finds the same one on every machine. Allocates nothing.
template <int kMostRows, int kMostColumns>
class AssignmentSolver {
 public:
  /// @param cost cost(row, column), finite @param rows no more than columns
  /// @return the sum of the costs
  template <class Cost>
  double Solve(int rows, int columns, const Cost& cost) {
    // Row and column 0 are the ends of a path; the others count from 1.
    row_of_.fill(0);
    price_.fill(0.0);
    std::array<double, kMostRows + 1> worth{};
    std::array<int, kMostColumns + 1> from{};
    for (int row = 1; row <= rows; ++row) {
      std::array<double, kMostColumns + 1> slack;
      std::array<bool, kMostColumns + 1> used{};
      slack.fill(std::numeric_limits<double>::infinity());
      int column = 0;
      row_of_[0] = row;
      do {
        used[At(column)] = true;
        const int at_row = row_of_[At(column)];
        double least = std::numeric_limits<double>::infinity();
        int next = 0;
        for (int c = 1; c <= columns; ++c) {
          if (used[At(c)]) continue;
          const double reduced = cost(at_row - 1, c - 1) - worth[At(at_row)] - price_[At(c)];
          if (reduced < slack[At(c)]) {
            slack[At(c)] = reduced;
            from[At(c)] = column;
          }
          if (slack[At(c)] < least) {
            least = slack[At(c)];
            next = c;
          }
        }
        for (int c = 0; c <= columns; ++c) {
          if (used[At(c)]) {
            worth[At(row_of_[At(c)])] += least;
            price_[At(c)] -= least;
          } else {
            slack[At(c)] -= least;
          }
        }
        column = next;
      } while (row_of_[At(column)] != 0);
      while (column != 0) {
        const int before = from[At(column)];
        row_of_[At(column)] = row_of_[At(before)];
        column = before;
      }
    }
    double sum = 0.0;
    for (int c = 1; c <= columns; ++c) {
      if (row_of_[At(c)] == 0) continue;
      column_of_[At(row_of_[At(c)] - 1)] = c - 1;
      sum += cost(row_of_[At(c)] - 1, c - 1);
    }
    return sum;
  }

  /// Column of a row in the last solution.
  int column_of(int row) const { return column_of_[At(row)]; }

 private:
  static constexpr std::size_t At(int k) { return static_cast<std::size_t>(k); }

  std::array<int, kMostColumns + 1> row_of_{};  // row of each column; 0: none
  std::array<double, kMostColumns + 1> price_{};
  std::array<int, kMostRows> column_of_{};
};

}  // namespace stg

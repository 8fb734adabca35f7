#include "set_distance.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/numbers/assignment.hpp"

namespace stg::task {

SetDistance DistanceOfSets(const Vec3<double>* a, int count_a, const Vec3<double>* b, int count_b,
                           double cutoff_m) {
  if (count_a > count_b) return DistanceOfSets(b, count_b, a, count_a, cutoff_m);
  if (count_b == 0) return {};
  const auto distance = [&](int i, int j) {
    return std::min(std::hypot(a[i].x - b[j].x, a[i].y - b[j].y), cutoff_m);
  };
  constexpr int kMost = 16;
  AssignmentSolver<kMost, kMost> solver;
  const double pairs = solver.Solve(count_a, count_b, distance);
  const int left = count_b - count_a;
  return {(pairs + cutoff_m * left) / count_b, pairs + 0.5 * cutoff_m * left};
}

}  // namespace stg::task

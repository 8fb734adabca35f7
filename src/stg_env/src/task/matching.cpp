#include <algorithm>
#include <cmath>

#include "auv_common/numbers/assignment.hpp"
#include "stg_env/task/swarm_state.hpp"
#include "totals/set_distance.hpp"

namespace stg::task {

template <class T>
void Following<T>::Match(std::size_t i, const std::vector<dynamics::TargetState<T>>& targets) {
  constexpr double kBeyond = 1e-3;  // beyond it, a nearer target is preferred a little
  const std::size_t n = targets.size();
  AssignmentSolver<dynamics::kMostTargets, dynamics::kMostTargets> solver;
  for (int lane = 0; lane < kLanesOf<T>; ++lane) {
    const auto cost = [&](int estimate, int t) {
      const Vec3<double> a = Lane(p_WT[i * n + static_cast<std::size_t>(estimate)], lane);
      const Vec3<double> b = Lane(targets[static_cast<std::size_t>(t)].p_WT, lane);
      const double apart = std::hypot(a.x - b.x, a.y - b.y);
      return std::min(apart, kCutoff_m) + kBeyond * apart;
    };
    solver.Solve(static_cast<int>(n), static_cast<int>(n), cost);
    const int followed = static_cast<int>(Lane(target[i], lane));
    SetLane(&target[i], lane, static_cast<double>(solver.column_of(followed)));
  }
}

template struct Following<double>;
template struct Following<Pack>;

}  // namespace stg::task

#include "stg_agent/estimation/joint_association.hpp"

#include "auv_common/numbers/short_list.hpp"

namespace stg::agent {
namespace {

using Targets = ShortList<int, kMostExact>;

double At(const LookOdds& odds, int j, int t) {
  return odds[static_cast<std::size_t>(j)][static_cast<std::size_t>(t)];
}

/// Sum of the products of odds over all joint associations of allowed pairs.
template <class Allowed>
double SumOfProducts(const LookOdds& odds, int detections, const Targets& targets,
                     const Allowed& allowed) {
  // By the set of targets that have one of the detections so far.
  std::array<double, 1U << kMostExact> sums{};
  sums[0] = 1.0;
  const unsigned sets = 1U << targets.size();
  for (int j = 0; j < detections; ++j) {
    for (unsigned set = sets; set-- > 0;) {  // the smaller sets still lack detection j
      unsigned bit = 1U;
      for (const int t : targets) {
        if ((set & bit) != 0U && allowed(j, t)) sums[set] += sums[set ^ bit] * At(odds, j, t);
        bit <<= 1U;
      }
    }
  }
  double total = 0.0;
  for (unsigned set = 0; set < sets; ++set) total += sums[set];
  return total;
}

}  // namespace

double RivalsOf(const LookOdds& odds, int detections, int targets, int detection, int target) {
  Targets possible;
  double alone = 0.0;  // sum of the odds of all rivals
  int count = 0;
  for (int t = 0; t < targets; ++t) {
    double sum = 0.0;
    for (int j = 0; j < detections; ++j) {
      sum += At(odds, j, t);
      if ((j == detection) != (t == target)) alone += At(odds, j, t);
    }
    if (sum > 0.0 && ++count <= kMostExact) possible.push_back(t);
  }
  if (alone == 0.0 || count > kMostExact) return alone;
  const double without_pair = SumOfProducts(
      odds, detections, possible, [&](int j, int t) { return j != detection || t != target; });
  const double without_both = SumOfProducts(
      odds, detections, possible, [&](int j, int t) { return j != detection && t != target; });
  return without_pair / without_both - 1.0;
}

}  // namespace stg::agent

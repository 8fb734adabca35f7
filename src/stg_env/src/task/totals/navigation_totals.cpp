#include <algorithm>
#include <cmath>

#include "stg_env/task/estimate_totals.hpp"

namespace stg::task {

std::vector<std::pair<std::string, double>> NavigationMetrics::Items() const {
  std::vector<std::pair<std::string, double>> items{{"navigation_rmse", rmse},
                                                    {"navigation_rmse_tail", rmse_tail},
                                                    {"navigation_nees", nees},
                                                    {"relative_rmse", relative_rmse}};
  if (surfacing) {
    items.emplace_back("fixes", surfacing->fixes);
    items.emplace_back("surface_share", surfacing->surface_share);
    items.emplace_back("navigation_rmse_before_fix", surfacing->rmse_before_fix);
  }
  return items;
}

template <class T>
void NavigationTotals<T>::Start(const Mask<T>& lanes) {
  Sums& s = sums_;
  for (T* sum : {&s.located, &s.square, &s.tail, &s.in_tail, &s.nees, &s.relative, &s.surfacing,
                 &s.before_fix, &s.fixings, &newest_square_}) {
    *sum = Select(lanes, T(0.0), *sum);
  }
  fixes_ = Select(lanes, T(-1.0), fixes_);
}

template <class T>
void NavigationTotals<T>::Add(const SwarmState<T>& swarm, const Mask<T>& tail) {
  const T zero(0.0), one(1.0);
  Sums& s = sums_;
  T fixes(0.0), squares(0.0), count(0.0);
  for (const FieldState<T>& f : *swarm.field) {
    const auto located = (f.located > T(0.5)) && (f.present > T(0.5));
    const T &x = f.navigation_error.x, &y = f.navigation_error.y;
    const T square = x * x + y * y;
    const T(&P)[3] = f.navigation_covariance;
    const T determinant = P[0] * P[2] - P[1] * P[1];
    const auto stated = determinant > zero;
    const T nees =
        (P[2] * x * x - T(2.0) * P[1] * x * y + P[0] * y * y) / Select(stated, determinant, one);
    s.located += Select(located, one, zero);
    s.square += Select(located, square, zero);
    s.tail += Select(tail && located, square, zero);
    s.in_tail += Select(tail && located, one, zero);
    s.nees += Select(stated && located, nees, zero);
    s.relative += Select(located, f.relative_square, zero);
    s.surfacing += Select(located, f.surfacing, zero);
    fixes += f.fixes;
    squares += Select(located, square, zero);
    count += Select(located, one, zero);
  }
  const auto fixed = (fixes > fixes_) && (fixes > zero);
  s.before_fix += Select(fixed, newest_square_, zero);
  s.fixings += Select(fixed, one, zero);
  fixes_ = fixes;
  newest_square_ = squares / Max(count, one);
}

template <class T>
std::optional<NavigationMetrics> NavigationTotals<T>::Metrics(int lane) const {
  const auto at = [lane](const T& value) { return Lane(value, lane); };
  const double all = at(sums_.located);
  if (all == 0.0) return {};
  NavigationMetrics m;
  m.rmse = std::sqrt(at(sums_.square) / all);
  m.rmse_tail = std::sqrt(at(sums_.tail) / std::max(1.0, at(sums_.in_tail)));
  m.nees = at(sums_.nees) / all;
  m.relative_rmse = std::sqrt(at(sums_.relative) / all);
  if (at(fixes_) >= 0.0) {
    m.surfacing = {at(fixes_), at(sums_.surfacing) / all,
                   std::sqrt(at(sums_.before_fix) / std::max(1.0, at(sums_.fixings)))};
  }
  return m;
}

template class NavigationTotals<double>;
template class NavigationTotals<Pack>;

}  // namespace stg::task

#include "stg_agent/inbox/one_target.hpp"

#include <cmath>

#include "stg_agent/estimation/association.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

double OneTarget::Reach(const Detection& a, const Detection& b) const {
  const bool range = b.kind == MeasurementKind::kRange;
  const double way = max_speed_mps_ * std::abs(Seconds(b.stamp - a.stamp));
  const double own = range ? Norm(b.p_WO - a.p_WO) : 0.0;
  const double noise =
      range ? std::hypot(a.range_std_m, b.range_std_m) : std::hypot(a.std_m, b.std_m);
  return way + own + std::sqrt(Gate(dynamics::NumbersOf(b.kind))) * noise;
}

bool OneTarget::MayCause(const Detection& a, const Detection& b) const {
  const double apart =
      b.kind == MeasurementKind::kRange ? std::abs(b.range_m - a.range_m) : Norm(b.p_WT - a.p_WT);
  return apart <= Reach(a, b);
}

}  // namespace stg::agent

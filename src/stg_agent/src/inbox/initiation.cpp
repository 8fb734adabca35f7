#include "stg_agent/inbox/initiation.hpp"

#include <algorithm>
#include <cmath>

#include "stg_agent/estimation/association.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

Initiation::Initiation(const AgentModel& model)
    : max_speed_mps_(model.target.max_speed_mps),
      longest_(static_cast<TimeNs>(1e9 * (kLooks - 1) *
                                   std::max(model.sensing.period_s, model.run.decision_dt_s()))) {}

bool Initiation::MayStart(const Detection& d) const {
  return d.kind != MeasurementKind::kBearing && !d.ambiguous;
}

double Initiation::Reach(const Detection& a, const Detection& b) const {
  const bool range = b.kind == MeasurementKind::kRange;
  const double way = max_speed_mps_ * std::abs(Seconds(b.stamp - a.stamp));
  const double own = range ? Norm(b.p_WO - a.p_WO) : 0.0;
  const double noise =
      range ? std::hypot(a.range_std_m, b.range_std_m) : std::hypot(a.std_m, b.std_m);
  return way + own + std::sqrt(Gate(dynamics::NumbersOf(b.kind))) * noise;
}

bool Initiation::Fits(const Detection& a, const Detection& b) const {
  const double apart =
      b.kind == MeasurementKind::kRange ? std::abs(b.range_m - a.range_m) : Norm(b.p_WT - a.p_WT);
  return apart <= Reach(a, b);
}

bool Initiation::Look(const Detection* detections, int count) {
  if (count == 0) return false;
  if (!chain_.empty() && detections[0].stamp - chain_[0].stamp > longest_) chain_.clear();
  for (int k = 0; k < count; ++k) {
    const Detection& d = detections[k];
    if (!MayStart(d)) continue;
    if (!chain_.empty() && !Fits(chain_[chain_.size() - 1], d)) continue;
    chain_.push_back(d);
    return chain_.full();
  }
  return false;
}

}  // namespace stg::agent

#include "stg_agent/inbox/initiation.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

Initiation::Initiation(const AgentModel& model)
    : pair_(model), longest_(static_cast<TimeNs>(1e9 * (kLooks - 1) * model.look_period_s())) {}

bool Initiation::MayStart(const Detection& d) const {
  return d.kind != MeasurementKind::kBearing && !d.ambiguous;
}

bool Initiation::Look(const Detection* detections, int count) {
  if (count == 0) return false;
  if (!chain_.empty() && detections[0].stamp - chain_[0].stamp > longest_) chain_.clear();
  for (int k = 0; k < count; ++k) {
    const Detection& d = detections[k];
    if (!MayStart(d)) continue;
    if (!chain_.empty() && !pair_.MayCause(chain_[chain_.size() - 1], d)) continue;
    chain_.push_back(d);
    return chain_.full();
  }
  return false;
}

}  // namespace stg::agent

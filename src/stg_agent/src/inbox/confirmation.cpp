#include "stg_agent/inbox/confirmation.hpp"

#include <algorithm>

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

Confirmation::Confirmation(const AgentModel& model)
    : needed_(model.sensing.relative().false_alarm_probability > 0.0),
      longest_(static_cast<TimeNs>(1e9 * kLooks * model.look_period_s())),
      pair_(model) {}

bool Confirmation::Take(const Detection& d) {
  if (!needed_ || d.kind == MeasurementKind::kBearing) return true;
  const auto supports = [&](const Detection& before) {
    return d.stamp - before.stamp <= longest_ && pair_.MayCause(before, d);
  };
  const auto found = std::count_if(recent_.begin(), recent_.end(), supports);
  recent_.insert(0, d);
  return found >= kNeeded;
}

}  // namespace stg::agent

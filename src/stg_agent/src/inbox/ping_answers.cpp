#include "stg_agent/inbox/ping_answers.hpp"

#include <algorithm>
#include <cmath>

namespace stg::agent {
namespace {

/// Most answers between two decisions; a modem has one ping at a time.
constexpr std::size_t kMostBetween = 8;

}  // namespace

PingAnswers::PingAnswers(const AgentModel& model)
    : pings_(model.sensing.pings()),
      first_target_(model.members()),
      targets_(model.target.count),
      reach_m_(model.sensing.range_m),
      options_(model.sensing.relative()),
      sound_(model.channel.physical.water),
      surface_z_m_(model.channel.physical.water.surface_z_m),
      way_(model.run) {
  answers_.reserve(kMostBetween);
}

void PingAnswers::Clear() {
  way_.Clear();
  answers_.clear();
}

void PingAnswers::Keep(const acoustics::Reception& reception) {
  const int target = reception.source - first_target_;
  const bool sane = std::isfinite(reception.travel_time_s) && reception.travel_time_s >= 0.0;
  if (pings_ && target >= 0 && target < targets_ && sane && answers_.size() < kMostBetween) {
    answers_.push_back({target, reception.generation, reception.travel_time_s});
  }
}

bool PingAnswers::Read(const Answer& answer, const OwnReckoning& own, double heading_std_rad,
                       dynamics::Detection* d) const {
  *d = dynamics::Detection();
  if (!way_.At(answer.at, &d->p_WO)) return false;
  d->kind = dynamics::MeasurementKind::kRange;
  d->stamp = answer.at;
  d->target = answer.target;
  d->range_m = answer.travel_time_s * sound_.At(std::max(0.0, surface_z_m_ - d->p_WO.z));
  d->range_std_m = options_.range_std(d->range_m);
  d->p_WT = d->p_WO;
  d->std_m = reach_m_;
  d->p_WO_std_m = own.position_std_m;
  d->heading_std_rad = heading_std_rad;
  return true;
}

}  // namespace stg::agent

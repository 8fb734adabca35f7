#include "stg_agent/inbox/unlabelled_input.hpp"

#include <algorithm>
#include <cmath>

#include "auv_dynamics/sensing/target_sensor.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

UnlabelledInput::UnlabelledInput(const AgentModel& model, int self)
    : self_(self),
      same_(std::max<TimeNs>(1, model.run.decision_period() / 16)),
      heard_(static_cast<std::size_t>(model.run.agents)),
      initiation_(model),
      confirmations_(static_cast<std::size_t>(model.beliefs()), Confirmation(model)) {
  pending_.reserve(kMostPending);
  for (Heard& heard : heard_) heard.ring.reserve(kMostHeard);
  Clear();
}

void UnlabelledInput::Clear() {
  pending_.clear();
  for (Heard& heard : heard_) {
    heard.ring.clear();
    heard.next = 0;
  }
  initiation_.Clear();
  for (Confirmation& confirmation : confirmations_) confirmation.Clear();
  own_detections_.fill(-1);
}

void UnlabelledInput::Detect(const Detection& detection) {
  if (pending_.size() == kMostPending) return;
  pending_.push_back({detection, self_});
  dynamics::RemoveLabel(&pending_.back().detection);
}

bool UnlabelledInput::Same(const Detection& a, const Detection& b) const {
  constexpr double kSameNumber = 1e-6;
  if (std::abs(a.stamp - b.stamp) >= same_) return false;
  // The observer's place and the rest are sent relative to the sender's place, so they are not
  // equal to the last digit.
  if (a.kind == MeasurementKind::kRange) return std::abs(a.range_m - b.range_m) < kSameNumber;
  if (a.kind == MeasurementKind::kBearing) {
    return std::abs(a.azimuth_rad - b.azimuth_rad) < kSameNumber &&
           std::abs(a.elevation_rad - b.elevation_rad) < kSameNumber;
  }
  return Norm(a.p_WT - b.p_WT) < kSameNumber;
}

void UnlabelledInput::Hear(const NeighbourState& packet) {
  Heard& heard = heard_[static_cast<std::size_t>(packet.source)];
  for (const Detection& d : packet.sightings) {
    const auto same = [&](const Detection& before) { return Same(before, d); };
    if (std::any_of(heard.ring.begin(), heard.ring.end(), same)) continue;
    if (pending_.size() == kMostPending) return;
    pending_.push_back({d, packet.source});
    if (heard.ring.size() < kMostHeard) {
      heard.ring.push_back(d);
    } else {
      heard.ring[heard.next] = d;
      heard.next = (heard.next + 1) % kMostHeard;
    }
  }
}

bool UnlabelledInput::Before(const Input& a, const Input& b) {
  const Detection &d = a.detection, &e = b.detection;
  if (d.stamp != e.stamp) return d.stamp < e.stamp;
  if (a.source != b.source) return a.source < b.source;
  if (dynamics::MeasuresLess(d, e) || dynamics::MeasuresLess(e, d)) {
    return dynamics::MeasuresLess(d, e);
  }
  return d.target < e.target;
}

void UnlabelledInput::Give(TimeNs now, Filters* filters) {
  std::sort(pending_.begin(), pending_.end(), Before);
  std::size_t first = 0;
  while (first < pending_.size() && pending_[first].detection.stamp <= now) {
    const Input& a = pending_[first];
    std::size_t end = first + 1;
    while (end < pending_.size() && pending_[end].source == a.source &&
           pending_[end].detection.stamp == a.detection.stamp) {
      ++end;
    }
    GiveLook(&a, static_cast<int>(std::min<std::size_t>(end - first, LookAssignment::kMost)),
             filters);
    first = end;
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(first));
}

void UnlabelledInput::GiveLook(const Input* look, int count, Filters* filters) {
  double gain[LookAssignment::kMost][LookAssignment::kMost];
  bool started[LookAssignment::kMost];
  const int targets = static_cast<int>(filters->size());
  bool complete = true;
  for (int t = 0; t < targets; ++t) {
    for (int j = 0; j < count; ++j) {
      const Detection& d = look[j].detection;
      const DetectionFit fit = (*filters)[static_cast<std::size_t>(t)]->Fit(d, look[j].source);
      gain[j][t] = InGate(fit, d.kind) ? fit.gain : 0.0;
      started[t] = fit.started;
    }
    complete = complete && started[t];
  }
  assignment_.Solve(count, targets, [&gain](int j, int t) { return gain[j][t]; });
  std::array<Detection, LookAssignment::kMost> free;
  int left = 0;
  for (int j = 0; j < count; ++j) {
    int target = assignment_.target_of(j);
    const int name = look[j].detection.target;
    if (target < 0 && name >= 0 && name < targets && !started[name]) target = name;
    if (target >= 0) {
      Take(target, look[j], assignment_.rivals(j), filters);
    } else {
      free[static_cast<std::size_t>(left++)] = look[j].detection;
    }
  }
  if (look->source != self_) return;
  if (complete) {
    initiation_.Clear();
  } else {
    StartMissing(free.data(), left, filters);
  }
}

void UnlabelledInput::Take(int target, const Input& input, double rivals, Filters* filters,
                           bool starts) {
  TargetFilter& filter = *(*filters)[static_cast<std::size_t>(target)];
  Detection d = input.detection;
  d.target = target;
  if (input.source == self_) {
    const bool supported = confirmations_[static_cast<std::size_t>(target)].Take(d);
    if (!supported && !starts) return;
    TimeNs& newest = own_detections_[static_cast<std::size_t>(target)];
    newest = std::max(newest, d.stamp);
  }
  filter.Assign(d, input.source, rivals);
}

void UnlabelledInput::StartMissing(const Detection* free, int count, Filters* filters) {
  if (!initiation_.Look(free, count)) return;
  const Detection& first = initiation_.chain()[0];
  const auto missing = std::find_if(filters->begin(), filters->end(), [&](const auto& filter) {
    return !filter->Fit(first, self_).started;
  });
  if (missing == filters->end()) return;
  const int target = static_cast<int>(missing - filters->begin());
  for (const Detection& d : initiation_.chain()) Take(target, {d, self_}, 0.0, filters, true);
  initiation_.Clear();
}

}  // namespace stg::agent

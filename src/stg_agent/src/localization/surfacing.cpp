#include "stg_agent/localization/surfacing.hpp"

#include <algorithm>
#include <cstddef>

#include "stg_agent/agent_config.hpp"

namespace stg::agent {
namespace {

constexpr TimeNs kSecond = 1'000'000'000;
constexpr TimeNs kAnnounced = 300 * kSecond;  ///< validity of an announcement
constexpr TimeNs kKnown = 120 * kSecond;      ///< an AUV whose last packet is older is ignored
/// An AUV waits this long for each AUV that is shallower, because that one goes first.
constexpr TimeNs kNextWaits = 60 * kSecond;
/// It stays on its way for longer than planned by at most this factor and this time [s].
constexpr double kPatience = 2.0, kPatience_s = 60.0;
constexpr double kBack_m = 1.0;  ///< at a smaller distance from its former depth it has returned
constexpr double kSlowing_ps = 0.25;   ///< climb rate per remaining depth
constexpr double kPressing_mps = 0.1;  ///< climb rate against the surface

}  // namespace

Surfacing::Surfacing(const AgentModel& model, int self)
    : self_(self),
      limit_mps_(model.vehicle.max_velocity_mps[2]),
      surface_std_m_(model.localization.surface_std_m),
      first_fix_s_(model.navigation.gps_first_fix_s),
      heard_(static_cast<std::size_t>(model.run.agents)) {}

void Surfacing::Reset() {
  std::fill(heard_.begin(), heard_.end(), Heard());
  phase_ = Phase::kNone;
  climb_mps_ = 0.0;
  due_since_ = -1;
}

void Surfacing::Hear(const NeighbourState& packet) {
  const auto id = static_cast<std::size_t>(packet.source);
  if (id >= heard_.size() || packet.source == self_) return;
  Heard& h = heard_[id];
  if (packet.surfacing) h.announced = std::max(h.announced, packet.generation);
  if (packet.generation <= h.at) return;
  h.at = packet.generation;
  h.depth_m = -packet.p_W.z;
}

bool Surfacing::Announced(TimeNs now, int below) const {
  for (int id = 0; id < static_cast<int>(heard_.size()); ++id) {
    const Heard& h = heard_[static_cast<std::size_t>(id)];
    if (id < below && h.announced >= 0 && now - h.announced <= kAnnounced) return true;
  }
  return false;
}

int Surfacing::ShallowerThan(double depth_m, TimeNs now) const {
  int count = 0;
  for (int id = 0; id < static_cast<int>(heard_.size()); ++id) {
    const Heard& h = heard_[static_cast<std::size_t>(id)];
    if (id == self_ || h.at < 0 || now - h.at > kKnown) continue;
    if (h.depth_m < depth_m || (h.depth_m == depth_m && id < self_)) ++count;
  }
  return count;
}

bool Surfacing::Due(TimeNs now, double depth_m, const Localizer& localizer) {
  const double ahead_s = depth_m / limit_mps_ + first_fix_s_;
  if (localizer.ahead(ahead_s).std_m() <= surface_std_m_ ||
      Announced(now, static_cast<int>(heard_.size()))) {
    due_since_ = -1;
    return false;
  }
  if (due_since_ < 0) due_since_ = now;
  return now - due_since_ >= ShallowerThan(depth_m, now) * kNextWaits;
}

void Surfacing::Advance(TimeNs now, const Vec3<double>& p_WB, const Localizer& localizer) {
  const double depth_m = std::max(0.0, -p_WB.z);
  const auto begin = [&](Phase phase) {
    phase_ = phase;
    began_ = now;
  };
  const double planned_s = kPatience * from_depth_m_ / limit_mps_ + kPatience_s;
  switch (phase_) {
    case Phase::kNone:
      if (!Due(now, depth_m, localizer)) break;
      begin(Phase::kUp);
      from_depth_m_ = depth_m;
      due_since_ = -1;
      break;
    case Phase::kUp: {
      heard_[static_cast<std::size_t>(self_)].announced = now;
      const bool late = Seconds(now - began_) > planned_s + first_fix_s_;
      if (localizer.fixed() >= began_ || Announced(now, self_) || late) begin(Phase::kBack);
      break;
    }
    case Phase::kBack:
      if (depth_m >= from_depth_m_ - kBack_m || Seconds(now - began_) > planned_s) {
        begin(Phase::kNone);
      }
      break;
  }
  climb_mps_ = 0.0;
  if (phase_ == Phase::kUp) {
    climb_mps_ = std::min(limit_mps_, kPressing_mps + kSlowing_ps * depth_m);
  }
  if (phase_ == Phase::kBack) {
    climb_mps_ = -std::min(limit_mps_, kPressing_mps + kSlowing_ps * (from_depth_m_ - depth_m));
  }
}

}  // namespace stg::agent

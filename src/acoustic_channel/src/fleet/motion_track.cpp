#include "acoustic_channel/fleet/motion_track.hpp"

#include <algorithm>

namespace stg::acoustics {
namespace {

Vec3<double> Slope(const Vec3<double>& from, const Vec3<double>& to, TimeNs duration) {
  return (to - from) * (1.0 / Seconds(duration));
}

}  // namespace

MotionTrack::MotionTrack(const Options& options) : options_(options) {}

MotionTrack::Samples::const_iterator MotionTrack::FirstAfter(TimeNs t) const {
  return std::upper_bound(samples_.begin(), samples_.end(), t,
                          [](TimeNs time, const Sample& sample) { return time < sample.t; });
}

bool MotionTrack::Add(TimeNs t, const Motion& motion) {
  const auto place = FirstAfter(t);
  // Of several samples that are rounded to one stamp, the first one counts. A caller may already
  // have used it when the others arrive.
  if (place != samples_.cbegin() && (place - 1)->t == t) return false;
  samples_.insert(place, {t, motion});
  return true;
}

std::optional<Motion> MotionTrack::At(TimeNs t) const {
  const auto next = FirstAfter(t);
  if (next == samples_.begin()) return {};
  const auto last = next - 1;
  const bool bracketed = next != samples_.end() && next->t - last->t <= options_.patience;
  if (bracketed) return Between(*last, *next, t);
  if (t - last->t > options_.silent_after) return {};
  return Beyond(last, t);
}

std::optional<TimeNs> MotionTrack::newest() const {
  if (samples_.empty()) return {};
  return samples_.back().t;
}

std::optional<TimeNs> MotionTrack::NewestUntil(TimeNs t) const {
  const auto next = FirstAfter(t);
  if (next == samples_.begin()) return {};
  return (next - 1)->t;
}

void MotionTrack::ForgetBefore(TimeNs t) {
  // The two samples before t stay: the one that applies, and the one that gives it a velocity.
  const auto keep = FirstAfter(t) - samples_.cbegin() - 2;
  if (keep > 0) samples_.erase(samples_.begin(), samples_.begin() + keep);
}

Motion MotionTrack::Between(const Sample& a, const Sample& b, TimeNs t) const {
  const double share = Seconds(t - a.t) / Seconds(b.t - a.t);
  Motion m;
  m.p_W = a.motion.p_W + (b.motion.p_W - a.motion.p_W) * share;
  m.v_W = options_.has_velocity ? a.motion.v_W + (b.motion.v_W - a.motion.v_W) * share
                                : Slope(a.motion.p_W, b.motion.p_W, b.t - a.t);
  return m;
}

Motion MotionTrack::Beyond(Samples::const_iterator last, TimeNs t) const {
  Motion m = last->motion;
  if (!options_.has_velocity) {
    m.v_W = {0.0, 0.0, 0.0};
    if (last != samples_.begin() && last->t - (last - 1)->t <= options_.silent_after) {
      m.v_W = Slope((last - 1)->motion.p_W, m.p_W, last->t - (last - 1)->t);
    }
  }
  m.p_W = m.p_W + m.v_W * Seconds(t - last->t);
  return m;
}

}  // namespace stg::acoustics

#include "stg_agent/localization/joint_filter.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "joint_row.hpp"

namespace stg::agent {
namespace {

/// Share of its value that an Ornstein-Uhlenbeck process of unit variance keeps.
double ShareKept(double dt_s, double memory_s) { return std::exp(-dt_s / memory_s); }

}  // namespace

JointFilter::JointFilter(const LocalizationConfig& config, double start_std_m, int auvs,
                         const std::vector<AnchorModel>& anchors, int self,
                         const ClockModel& clocks, const HeadingModel& heading)
    : config_(config),
      clocks_(clocks),
      heading_(heading),
      start_variance_(Squared(start_std_m)),
      auvs_(auvs),
      self_(self),
      slots_(std::min(auvs, kMostObservers)),
      anchors_(anchors),
      anchor_clocks_(anchors.size(), -1),
      observers_(static_cast<std::size_t>(slots_)) {
  n_ = AnchorAt(auvs_ + static_cast<int>(anchors_.size()));
  first_heading_ = n_;
  if (heading_.estimated) n_ += slots_;
  first_clock_ = n_;
  if (clocks_.estimated) {
    n_ += 2 * slots_;
    for (std::size_t k = 0; k < anchors_.size(); ++k) {
      if (anchors_[k].on_time) continue;
      anchor_clocks_[k] = n_;
      n_ += 2;
    }
  }
  assert(n_ <= kMostJointStates);
  x_.resize(static_cast<std::size_t>(n_));
  P_.resize(static_cast<std::size_t>(n_ * n_));
  Clear();
}

int JointFilter::ClockAt(int id) const {
  if (IsAnchor(id)) return anchor_clocks_[static_cast<std::size_t>(id - auvs_)];
  return first_clock_ < n_ ? first_clock_ + 2 * SlotOf(id) : -1;
}

/// Sets the states of a clock without any measurement, t_s after the start.
void JointFilter::StartClock(int clock, double t_s) {
  Scale(clock, 0.0);
  Scale(clock + 1, 0.0);
  const double offset = Squared(clocks_.offset_std_s * kClockSound_mps);
  const double rate = Squared(clocks_.rate_std * kClockSound_mps);
  P(clock, clock) = offset + rate * t_s * t_s;
  P(clock, clock + 1) = P(clock + 1, clock) = rate * t_s;
  P(clock + 1, clock + 1) = rate;
}

/// Sets the error of a heading without any measurement, t_s after the start.
void JointFilter::StartHeading(int id, double t_s) {
  const int h = HeadingAt(id);
  if (h < 0) return;
  Scale(h, 0.0);
  P(h, h) = Squared(heading_.std_rad) + Squared(heading_.walk_rad) * t_s;
}

void JointFilter::Turn(int id, const Vec3<double>& way) {
  const int slot = SlotOf(id);
  if (slot < 0 || !heading_.estimated) return;
  Grow(ErrorAt(slot), first_heading_ + slot, -way.y);
  Grow(ErrorAt(slot) + 1, first_heading_ + slot, way.x);
}

void JointFilter::Clear() {
  now_ = 0;
  std::fill(x_.begin(), x_.end(), 0.0);
  std::fill(P_.begin(), P_.end(), 0.0);
  // The own AUV comes first, so it never loses its states to another AUV. The others follow by
  // index.
  int id = 0;
  for (int slot = 0; slot < slots_; ++slot) {
    const bool own = slot == 0 && !IsAnchor(self_);
    if (!own && id == self_) ++id;
    Reckoner& o = observers_[static_cast<std::size_t>(slot)];
    o = Reckoner();
    o.id = own ? self_ : id++;
    for (int axis = 0; axis < 2; ++axis) {
      P(ErrorAt(slot) + axis, ErrorAt(slot) + axis) = start_variance_;
      P(ShearAt(slot) + axis, ShearAt(slot) + axis) = Squared(config_.shear_std_mps);
    }
    StartHeading(o.id, 0.0);
  }
  for (int axis = 0; axis < 2; ++axis) {
    P(CurrentAt() + axis, CurrentAt() + axis) = Squared(config_.current_std_mps);
  }
  P(ScaleAt(), ScaleAt()) = Squared(config_.sound_speed_std);
  for (std::size_t k = 0; k < anchors_.size(); ++k) {
    const int g = AnchorAt(auvs_ + static_cast<int>(k));
    P(g, g) = P(g + 1, g + 1) = Squared(anchors_[k].std_m);
  }
  for (int clock = first_clock_; clock < n_; clock += 2) StartClock(clock, 0.0);
}

int JointFilter::SlotOf(int id) const {
  for (int slot = 0; slot < slots_; ++slot) {
    if (observers_[static_cast<std::size_t>(slot)].id == id) return slot;
  }
  return -1;
}

void JointFilter::Scale(int i, double share) {
  x_[static_cast<std::size_t>(i)] *= share;
  for (int c = 0; c < n_; ++c) P(i, c) *= share;
  for (int r = 0; r < n_; ++r) P(r, i) *= share;
}

/// Reduces a state to a share of itself and renews it to its own variance.
void JointFilter::Forget(int i, double share, double variance) {
  Scale(i, share);
  P(i, i) += variance * (1.0 - share * share);
}

/// A state grows by `share` times another one.
void JointFilter::Grow(int i, int by, double share) {
  x_[static_cast<std::size_t>(i)] += share * x_[static_cast<std::size_t>(by)];
  for (int c = 0; c < n_; ++c) P(i, c) += share * P(by, c);
  for (int r = 0; r < n_; ++r) P(r, i) += share * P(r, by);
}

void JointFilter::Predict(TimeNs now) {
  const double dt_s = Seconds(now - now_);
  if (dt_s <= 0.0) return;
  now_ = now;
  for (int clock = first_clock_; clock < n_; clock += 2) Grow(clock, clock + 1, dt_s);
  for (int h = first_heading_; h < first_clock_; ++h) P(h, h) += Squared(heading_.walk_rad) * dt_s;
  const int C = CurrentAt();
  for (int slot = 0; slot < slots_; ++slot) {
    if (!observers_[static_cast<std::size_t>(slot)].adrift) continue;
    for (int axis = 0; axis < 2; ++axis) {
      const int e = ErrorAt(slot) + axis, w = ShearAt(slot) + axis, common = C + axis;
      x_[static_cast<std::size_t>(e)] -=
          dt_s * (x_[static_cast<std::size_t>(common)] + x_[static_cast<std::size_t>(w)]);
      for (int c = 0; c < n_; ++c) P(e, c) -= dt_s * (P(common, c) + P(w, c));
      for (int r = 0; r < n_; ++r) P(r, e) -= dt_s * (P(r, common) + P(r, w));
    }
  }
  const double noise = Squared(config_.reckoning_std_m) * dt_s;
  const double w_kept = ShareKept(dt_s, config_.shear_memory_s);
  for (int slot = 0; slot < slots_; ++slot) {
    for (int axis = 0; axis < 2; ++axis) {
      P(ErrorAt(slot) + axis, ErrorAt(slot) + axis) += noise;
      Forget(ShearAt(slot) + axis, w_kept, Squared(config_.shear_std_mps));
    }
  }
  const double c_kept = ShareKept(dt_s, config_.current_memory_s);
  for (int axis = 0; axis < 2; ++axis) Forget(C + axis, c_kept, Squared(config_.current_std_mps));
  for (std::size_t k = 0; k < anchors_.size(); ++k) {
    if (anchors_[k].memory_s <= 0.0) continue;
    const int g = AnchorAt(auvs_ + static_cast<int>(k));
    const double g_kept = ShareKept(dt_s, anchors_[k].memory_s);
    for (int axis = 0; axis < 2; ++axis) Forget(g + axis, g_kept, Squared(anchors_[k].std_m));
  }
}

void JointFilter::SetAdrift(int id, bool adrift) {
  const int slot = SlotOf(id);
  if (slot >= 0) observers_[static_cast<std::size_t>(slot)].adrift = adrift;
}

void JointFilter::SetDepth(int id, double depth_m) {
  const int slot = SlotOf(id);
  if (slot < 0) return;
  Reckoner& o = observers_[static_cast<std::size_t>(slot)];
  if (o.dived && depth_m != o.depth_m) {
    const double kept = std::exp(-std::abs(depth_m - o.depth_m) / config_.shear_depth_m);
    for (int axis = 0; axis < 2; ++axis) {
      Forget(ShearAt(slot) + axis, kept, Squared(config_.shear_std_mps));
    }
  }
  o.dived = true;
  o.depth_m = depth_m;
}

void JointFilter::Admit(int id, TimeNs heard) {
  if (IsAnchor(id)) return;
  int slot = SlotOf(id);
  if (slot < 0) {
    slot = IsAnchor(self_) ? 0 : 1;
    if (slot >= slots_) return;
    for (int s = slot; s < slots_; ++s) {
      if (observers_[static_cast<std::size_t>(s)].heard <
          observers_[static_cast<std::size_t>(slot)].heard) {
        slot = s;
      }
    }
    Start(slot, id);
  }
  Reckoner& o = observers_[static_cast<std::size_t>(slot)];
  o.heard = std::max(o.heard, heard);
}

/// Starts the states of a new AUV. It came through the same water as the others. So its error
/// equals the error of another AUV, plus a difference that may have grown since the start.
void JointFilter::Start(int slot, int id) {
  const int like = slot == 0 ? 1 : 0;
  const double t = Seconds(now_);
  Reckoner& o = observers_[static_cast<std::size_t>(slot)];
  o = Reckoner();
  o.id = id;
  const double shear = Squared(config_.shear_std_mps);
  for (int axis = 0; axis < 2; ++axis) {
    const int e = ErrorAt(slot) + axis, w = ShearAt(slot) + axis, of = ErrorAt(like) + axis;
    Scale(e, 0.0);
    Scale(w, 0.0);
    if (like < slots_) {
      x_[static_cast<std::size_t>(e)] = x_[static_cast<std::size_t>(of)];
      for (int c = 0; c < n_; ++c) P(e, c) = P(of, c);
      for (int r = 0; r < n_; ++r) P(r, e) = P(r, of);
      P(e, e) = P(of, of);
    }
    P(e, e) += 2.0 * start_variance_ + 2.0 * shear * t * t;
    P(w, w) = shear;
    P(e, w) -= shear * t;
    P(w, e) -= shear * t;
  }
  StartHeading(id, t);
  if (first_clock_ < n_) StartClock(first_clock_ + 2 * slot, t);
}

PlaneError JointFilter::Spread(const Row& east, const Row& north) const {
  std::array<double, kMostJointStates> column;
  PlaneError e;
  e.x = Mean(east);
  e.y = Mean(north);
  e.yy = Column(north, column.data());
  e.xx = Column(east, column.data());
  for (int k = 0; k < north.count; ++k) {
    e.xy += north.value[static_cast<std::size_t>(k)] *
            column[static_cast<std::size_t>(north.index[static_cast<std::size_t>(k)])];
  }
  return e;
}

PlaneError JointFilter::Error(int id, TimeNs at) const {
  const double age_s = std::max(0.0, Seconds(now_ - at));
  Row east, north;
  AddError(id, 0, 1.0, age_s, &east);
  AddError(id, 1, 1.0, age_s, &north);
  return Spread(east, north);
}

PlaneError JointFilter::Ahead(int id, double ahead_s) const {
  Row east, north;
  AddError(id, 0, 1.0, -ahead_s, &east);
  AddError(id, 1, 1.0, -ahead_s, &north);
  PlaneError e = Spread(east, north);
  const int slot = SlotOf(id);
  const bool adrift = slot >= 0 && observers_[static_cast<std::size_t>(slot)].adrift;
  const double added =
      (adrift ? Wander(ahead_s) : 0.0) + Squared(config_.reckoning_std_m) * ahead_s;
  e.xx += added;
  e.yy += added;
  return e;
}

PlaneError JointFilter::Relative(int id, int than, TimeNs at) const {
  const double age_s = std::max(0.0, Seconds(now_ - at));
  Row east, north;
  AddError(id, 0, 1.0, age_s, &east);
  AddError(than, 0, -1.0, age_s, &east);
  AddError(id, 1, 1.0, age_s, &north);
  AddError(than, 1, -1.0, age_s, &north);
  return Spread(east, north);
}

PlaneError JointFilter::MeanError() const {
  Row east, north;
  for (int slot = 0; slot < slots_; ++slot) {
    east.Add(ErrorAt(slot), 1.0 / slots_);
    north.Add(ErrorAt(slot) + 1, 1.0 / slots_);
  }
  return Spread(east, north);
}

PlaneError JointFilter::Current() const {
  Row east, north;
  east.Add(CurrentAt(), 1.0);
  north.Add(CurrentAt() + 1, 1.0);
  return Spread(east, north);
}

double PlaneError::std_m() const {
  const double half = 0.5 * (xx - yy);
  return std::sqrt(std::max(0.0, 0.5 * (xx + yy) + std::sqrt(half * half + xy * xy)));
}

}  // namespace stg::agent

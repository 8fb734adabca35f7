#include "observers.hpp"

#include <algorithm>
#include <cmath>

namespace stg::agent {
namespace {

/// Scales state i of all components.
void Shrink(int i, double share, GaussianMixture* mixture) {
  const int stride = mixture->stride();
  for (int k = 0; k < mixture->size(); ++k) {
    const Gaussian g = mixture->at(k);
    g.x[i] *= share;
    for (int c = 0; c < stride; ++c) g.P[i * stride + c] *= share;
    for (int r = 0; r < stride; ++r) g.P[r * stride + i] *= share;
  }
}

void Grow(int i, double variance, GaussianMixture* mixture) {
  for (int k = 0; k < mixture->size(); ++k) {
    mixture->at(k).P[i * mixture->stride() + i] += variance;
  }
}

void Tie(int i, int j, double covariance, GaussianMixture* mixture) {
  const int stride = mixture->stride();
  for (int k = 0; k < mixture->size(); ++k) {
    double* P = mixture->at(k).P;
    P[i * stride + j] += covariance;
    P[j * stride + i] += covariance;
  }
}

void Follow(int i, double stated, double before, GaussianMixture* mixture) {
  if (stated >= before) {
    Grow(i, stated * stated - before * before, mixture);
  } else {
    Shrink(i, stated / before, mixture);
  }
}

/// If the stated error falls below this share of the previous one, a fix has corrected it.
constexpr double kFix = 0.7;
/// The own log has no bottom if the own deviation grows by more than this share of the current's
/// deviation. With the bottom in range it grows by about 1 % of the speed.
constexpr double kAdrift = 0.5;
/// Growth of the variance of a drifting position by the log, its scale and the heading, on each
/// axis [m^2/s]. It equals 0.06 m/s over one second, which includes scale and heading without their
/// own states.
constexpr double kReckoning = 0.06 * 0.06;

/// Correlation time of the remaining error of a localizer [s].
constexpr double kLocated_s = 100.0;

/// Adds `dt_s` times state `rate` to state i in all components.
void Drift(int i, int rate, double dt_s, double added, double kept, double renewed,
           GaussianMixture* mixture) {
  const int stride = mixture->stride();
  for (int k = 0; k < mixture->size(); ++k) {
    const Gaussian g = mixture->at(k);
    double *p = g.P + i * stride, *v = g.P + rate * stride;
    g.x[i] += dt_s * g.x[rate];
    g.x[rate] *= kept;
    for (int c = 0; c < stride; ++c) {
      p[c] += dt_s * v[c];
      v[c] *= kept;
    }
    for (int r = 0; r < stride; ++r) {
      double* row = g.P + r * stride;
      row[i] += dt_s * row[rate];
      row[rate] *= kept;
    }
    p[i] += added;
    v[rate] += renewed;
  }
}

}  // namespace

void Observers::Clear() {
  blocks_.fill(Block());
  adrift_ = false;
}

void Observers::Predict(double dt_s, GaussianMixture* mixture) const {
  if (layout_.located) Renew(dt_s, mixture);
  if (!layout_.rates || !adrift_ || dt_s <= 0.0) return;
  const double kept = std::exp(-dt_s / drift_.shear_memory_s);
  const double renewed = 2.0 * drift_.shear_variance * (1.0 - kept * kept);
  for (int b = 1; b < layout_.observers; ++b) {
    if (blocks_[static_cast<std::size_t>(b)].id < 0) continue;
    for (int axis = 0; axis < 2; ++axis) {
      const int i = layout_.block(b) + axis;
      Drift(i, i + layout_.rate(), dt_s, 2.0 * kReckoning * dt_s, kept, renewed, mixture);
    }
  }
}

/// Lets the remaining error of a localizer decorrelate.
void Observers::Renew(double dt_s, GaussianMixture* mixture) const {
  if (dt_s <= 0.0) return;
  const double kept = std::exp(-dt_s / kLocated_s);
  for (int b = 1; b < layout_.observers; ++b) {
    const Block& block = blocks_[static_cast<std::size_t>(b)];
    if (block.id < 0) continue;
    for (int axis = 0; axis < 2; ++axis) {
      Shrink(layout_.block(b) + axis, kept, mixture);
      Grow(layout_.block(b) + axis,
           block.position_std_m * block.position_std_m * (1.0 - kept * kept), mixture);
    }
  }
}

int Observers::BlockOf(int id) const {
  if (id == self_) return 0;
  int oldest = 1;
  for (int b = 1; b < layout_.observers; ++b) {
    const Block& block = blocks_[static_cast<std::size_t>(b)];
    if (block.id == id) return b;
    const Block& least = blocks_[static_cast<std::size_t>(oldest)];
    const bool free = block.id < 0 && least.id >= 0;
    if (free || (least.id >= 0 && block.used < least.used)) oldest = b;
  }
  return oldest;
}

int Observers::Admit(int id, TimeNs stamp, double position_std_m, double heading_std_rad,
                     GaussianMixture* mixture) {
  if (layout_.per_observer == 0) return 0;
  const int slot = BlockOf(id);
  Block& block = blocks_[static_cast<std::size_t>(slot)];
  const int first = layout_.block(slot);
  const bool is_new = block.id != id;
  mixture->Cover(first + layout_.per_observer);
  if (is_new) {
    for (int i = 0; i < layout_.per_observer; ++i) Shrink(first + i, 0.0, mixture);
    block = Block();
    block.id = id;
  }
  if (layout_.located && slot == 0) {
    // The own frame is the reference frame.
  } else if (!layout_.rates) {
    Follow(first, position_std_m, block.position_std_m, mixture);
    Follow(first + 1, position_std_m, block.position_std_m, mixture);
  } else if (slot == 0) {
    AdmitOwn(stamp, position_std_m, mixture);
  } else {
    AdmitOther(slot, is_new, position_std_m, mixture);
  }
  if (layout_.heading) Follow(first + 2, heading_std_rad, block.heading_std_rad, mixture);
  block.used = stamp;
  block.position_std_m = position_std_m;
  block.heading_std_rad = heading_std_rad;
  return slot;
}

void Observers::AdmitOwn(TimeNs stamp, double position_std_m, GaussianMixture* mixture) {
  const Block& own = blocks_[0];
  const double before = own.position_std_m;
  if (before <= 0.0 || stamp <= own.used) return;
  if (position_std_m >= kFix * before) {
    const double growth = (position_std_m - before) / Seconds(stamp - own.used);
    adrift_ = growth > kAdrift * drift_.current_std_mps;
    return;
  }
  // The own frame has jumped by about its previous error.
  Grow(0, before * before, mixture);
  Grow(1, before * before, mixture);
  for (std::size_t b = 1; b < blocks_.size(); ++b) blocks_[b].id = -1;
}

void Observers::AdmitOther(int slot, bool is_new, double position_std_m, GaussianMixture* mixture) {
  Block& block = blocks_[static_cast<std::size_t>(slot)];
  const int first = layout_.block(slot), rate = first + layout_.rate();
  const Block& own_block = blocks_[0];
  // Both AUVs have the same instruments in the same water. So while nothing is known about the own
  // error, it is taken to be as large as the other's.
  const double own = own_block.id < 0 ? position_std_m : own_block.position_std_m;
  const bool fixed = !is_new && position_std_m < kFix * block.position_std_m;
  const double shear = 2.0 * drift_.shear_variance;
  if (is_new || fixed) {
    for (int i = first; i < first + layout_.per_observer; ++i) Shrink(i, 0.0, mixture);
    const bool together = adrift_ && is_new && position_std_m > kFix * own;
    const double since_s = together ? own / drift_.current_std_mps : 0.0;
    for (int axis = 0; axis < 2; ++axis) {
      Grow(first + axis,
           together ? 2.0 * drift_.start_variance + shear * since_s * since_s
                    : position_std_m * position_std_m + own * own,
           mixture);
      Grow(rate + axis, shear, mixture);
      Tie(first + axis, rate + axis, shear * since_s, mixture);
    }
  } else if (!adrift_) {
    const auto grown = [](double now, double before) {
      return std::max(0.0, now * now - before * before);
    };
    const double added = grown(position_std_m, block.position_std_m) + grown(own, block.own_std_m);
    Grow(first, added, mixture);
    Grow(first + 1, added, mixture);
  }
  block.own_std_m = own;
}

}  // namespace stg::agent

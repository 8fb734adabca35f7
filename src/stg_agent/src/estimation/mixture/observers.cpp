#include "observers.hpp"

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

void Follow(int i, double stated, double before, GaussianMixture* mixture) {
  if (stated >= before) {
    Grow(i, stated * stated - before * before, mixture);
  } else {
    Shrink(i, stated / before, mixture);
  }
}

}  // namespace

void Observers::Clear() { blocks_.fill(Block()); }

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
  if (block.id != id) {
    for (int i = 0; i < layout_.per_observer; ++i) Shrink(first + i, 0.0, mixture);
    block = Block();
    block.id = id;
  }
  Follow(first, position_std_m, block.position_std_m, mixture);
  Follow(first + 1, position_std_m, block.position_std_m, mixture);
  if (layout_.per_observer > 2) {
    Follow(first + 2, heading_std_rad, block.heading_std_rad, mixture);
  }
  block.used = stamp;
  block.position_std_m = position_std_m;
  block.heading_std_rad = heading_std_rad;
  return slot;
}

}  // namespace stg::agent

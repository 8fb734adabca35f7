#pragma once

#include <array>

#include "auv_common/time.hpp"
#include "gaussian_mixture.hpp"
#include "sighting_model.hpp"

namespace stg::agent {

/// Which observer's errors lie in which block of the state, and how large they are as last stated.
/// The AUV itself has block 0 for good; others take the block that was used least recently.
class Observers {
 public:
  Observers(const StateLayout& layout, int self) : layout_(layout), self_(self) {}

  /// Forgets everybody.
  void Clear();
  /// The block of AUV `id`, whose errors become as large as they are stated to be at a time: what
  /// they have grown by is new, what a fix has taken from them they lose as a whole. Zero where
  /// navigation is perfect.
  int Admit(int id, TimeNs stamp, double position_std_m, double heading_std_rad,
            GaussianMixture* mixture);

 private:
  static constexpr int kMost = 8;
  struct Block {
    int id = -1;  ///< nobody
    TimeNs used = 0;
    double position_std_m = 0.0, heading_std_rad = 0.0;
  };
  int BlockOf(int id) const;

  StateLayout layout_;
  int self_;
  std::array<Block, kMost> blocks_{};
};

}  // namespace stg::agent

#pragma once

#include <array>

#include "auv_common/time.hpp"
#include "gaussian_mixture.hpp"
#include "sighting_model.hpp"

namespace stg::agent {

/// How far navigation drifts, as far as an AUV knows: what Observers reckon with where errors grow
/// at rates (StateLayout::rates).
struct DriftModel {
  double current_std_mps = 0.0;  ///< of each component of the current, which all AUVs share
  double shear_variance = 0.0;   ///< of what one AUV's current differs by, each axis [m^2/s^2]
  double shear_memory_s = 1.0;
  double start_variance = 0.0;  ///< of a position when an episode starts, each axis [m^2]
};

/// Which observer's errors lie in which block of the state, and how large they are as last stated.
/// The AUV itself has block 0 for good; others take the block that was used least recently.
///
/// With steps, an error is of the world, and what it has grown by since it was last stated is new.
/// With rates, an error is against the own one: a drift that all share is not in it, and while the
/// logs find no bottom it grows at a rate that is a state, too. So a current that carries everybody
/// alike blurs nothing that the vehicle steers by. With a localizer, an error is what that leaves
/// of it, which is forgotten in a while; the deviations that are stated are those.
class Observers {
 public:
  Observers(const StateLayout& layout, const DriftModel& drift, int self)
      : layout_(layout), drift_(drift), self_(self) {}

  /// Forgets everybody.
  void Clear();
  /// Carries the errors over a time.
  void Predict(double dt_s, GaussianMixture* mixture) const;
  /// The block of AUV `id`, whose errors become as large as they are stated to be at a time; a fix
  /// takes from them as a whole. Zero where navigation is perfect.
  int Admit(int id, TimeNs stamp, double position_std_m, double heading_std_rad,
            GaussianMixture* mixture);

 private:
  static constexpr int kMost = 8;
  struct Block {
    int id = -1;  ///< none
    TimeNs used = 0;
    double position_std_m = 0.0, heading_std_rad = 0.0;
    double own_std_m = 0.0;  ///< deviation of the own position then
  };
  void Renew(double dt_s, GaussianMixture* mixture) const;
  int BlockOf(int id) const;
  void AdmitOwn(TimeNs stamp, double position_std_m, GaussianMixture* mixture);
  void AdmitOther(int slot, bool is_new, double position_std_m, GaussianMixture* mixture);

  StateLayout layout_;
  DriftModel drift_;
  int self_;
  bool adrift_ = false;  // the own log finds no bottom
  std::array<Block, kMost> blocks_{};
};

}  // namespace stg::agent

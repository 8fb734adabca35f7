#pragma once

#include <array>

#include "auv_common/time.hpp"
#include "gaussian_mixture.hpp"
#include "sighting/sighting_model.hpp"

namespace stg::agent {

/// An AUV's model of how navigation drifts. Observers use it if errors grow at rates
/// (StateLayout::rates).
struct DriftModel {
  double current_std_mps = 0.0;  ///< of each component of the current that all AUVs share
  /// Of the difference between the current at an AUV and the common one, each axis [m^2/s^2].
  double shear_variance = 0.0;
  double shear_memory_s = 1.0;
  double start_variance = 0.0;  ///< of a position at the start of an episode, each axis [m^2]
};

/// Assigns blocks of the state to the errors of observers, with the size of the errors as last
/// stated. The AUV itself always has block 0. Another observer takes the block that was used least
/// recently.
///
/// With steps, an error is relative to the world, and its growth since the last statement is
/// independent of it. With rates, an error is relative to the own one. A drift that all AUVs share
/// is not in it. While the logs have no bottom, the error grows at a rate, which is a state, too.
/// So a current that carries all AUVs in the same way does not add uncertainty to the values that
/// the vehicle steers by. With a localizer, an error is the remaining error after it, which
/// decorrelates after a while; the stated deviations are then for the remaining error.
class Observers {
 public:
  Observers(const StateLayout& layout, const DriftModel& drift, int self)
      : layout_(layout), drift_(drift), self_(self) {}

  /// Forgets all observers.
  void Clear();
  /// Propagates the errors over a time.
  void Predict(double dt_s, GaussianMixture* mixture) const;
  /// The block of AUV `id`. Its errors become as large as they are stated at a time; after a fix
  /// they are replaced. Returns 0 if navigation is perfect.
  int Admit(int id, TimeNs stamp, double position_std_m, double heading_std_rad,
            GaussianMixture* mixture);

 private:
  struct Block {
    int id = -1;  ///< -1: none
    TimeNs used = 0;
    double position_std_m = 0.0, heading_std_rad = 0.0;
    double own_std_m = 0.0;  ///< deviation of the own position at that time
  };
  void Renew(double dt_s, GaussianMixture* mixture) const;
  int BlockOf(int id) const;
  void AdmitOwn(TimeNs stamp, double position_std_m, GaussianMixture* mixture);
  void AdmitOther(int slot, bool is_new, double position_std_m, GaussianMixture* mixture);

  StateLayout layout_;
  DriftModel drift_;
  int self_;
  bool adrift_ = false;  // the own log has no bottom
  std::array<Block, kMostObservers> blocks_{};
};

}  // namespace stg::agent

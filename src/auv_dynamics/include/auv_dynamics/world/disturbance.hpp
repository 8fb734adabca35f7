#pragma once

#include <vector>

#include "auv_dynamics/episode_clock.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/world/surroundings_config.hpp"

namespace stg::dynamics {

/// w of Eq. 3: a first-order Gauss-Markov force and moment on each vehicle, discretised exactly
/// and started in its stationary distribution.
class Disturbance {
 public:
  Disturbance(const DisturbanceConfig& config, int vehicles, double dt_s);

  /// Advances to the step of each lane's clock.
  void Advance(const EpisodeClocks& clocks);
  /// On vehicle i, body axes.
  const Wrench<Pack>& wrench(int i) const { return wrenches_[static_cast<size_t>(i)]; }

 private:
  DisturbanceConfig config_;
  double decay_;  // of one step
  double drive_;  // of a standard deviation of fresh noise
  std::vector<Wrench<Pack>> wrenches_;
};

}  // namespace stg::dynamics

#pragma once

#include <cmath>

#include "auv_dynamics/targets/target_motion.hpp"

namespace stg::dynamics {

/// Velocity v turned towards a direction by at most `angle` [rad], at its own speed.
Vec3<double> TurnTowards(const Vec3<double>& v, const Vec3<double>& direction, double angle);

/// A motion that steers one target at a time. Near a wall, or in open water near the edge of the
/// region, the target turns towards the centre; elsewhere the derived class steers it. It is never
/// faster than `target.max_speed_mps`.
class SteeredMotion : public TargetMotion {
 public:
  explicit SteeredMotion(const MotionSetup& setup);
  void Step(const EpisodeClocks& clocks, const std::vector<VehicleState<Pack>>& vehicles,
            std::vector<TargetState<Pack>>* targets) final;

 protected:
  /// One target in one lane.
  struct Situation {
    int lane;
    int target;
    const EpisodeClock& clock;
    Vec3<double> p_WT, v_WT;
    const std::vector<VehicleState<Pack>>& vehicles;
  };

  /// Velocity of the next step [m/s], world axes. Not called for targets that a wall turns back.
  virtual Vec3<double> Steer(const Situation& now) = 0;

  const TargetConfig& config() const { return config_; }
  double dt() const { return dt_; }
  double region() const { return region_; }
  /// True: there are no walls but a band of depths, and targets move level.
  bool open_water() const { return std::isinf(half_extent_); }
  /// Largest turn of one step [rad].
  double largest_turn() const { return config_.max_turn_rate_radps * dt_; }

 private:
  TargetConfig config_;
  double dt_, half_extent_, region_;
};

}  // namespace stg::dynamics

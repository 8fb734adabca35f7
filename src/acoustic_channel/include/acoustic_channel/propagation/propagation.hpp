#pragma once

#include <complex>
#include <functional>

#include "acoustic_channel/propagation/propagation_config.hpp"
#include "acoustic_channel/water/sound_speed.hpp"
#include "acoustic_channel/water/water_config.hpp"
#include "auv_common/numbers/vector.hpp"

namespace stg::acoustics {

/// Whether the straight line between two points [m, world axes] is free. Empty: all lines are free.
using LineOfSight = std::function<bool(const Vec3<double>& a_W, const Vec3<double>& b_W)>;

/// Rician K above which a link does not fade: the draw would be within 0.02 dB of its mean.
inline constexpr double kSteadyRicianK = 1e6;

/// Propagation of a signal from one point to another, before any draw.
struct PathSum {
  double distance_m = 0.0;     ///< straight
  double travel_time_s = 0.0;  ///< of the straight path, which is the first
  double gain_db = 0.0;        ///< minus the transmission loss: sum of the powers of all paths
  /// Power of the straight path divided by the power of all others, at most kSteadyRicianK.
  double rician_k = 0.0;
  double delay_spread_s = 0.0;  ///< standard deviation of the delay over the power
  bool blocked = false;         ///< the line is not free; its loss is in gain_db
};

/// Spreading, absorption, reflections and shadow, from the configuration alone. Thread-safe;
/// allocates nothing.
///
/// Every path loses 10 k lg(L / 1 m) + a L / 1000 dB over its length L [m] (not below 1 m), and
/// what its reflections take. With one path, this is the link budget of Urick, and the Rician K is
/// the configuration's. With more paths, K follows from the straight path's share of the power, and
/// k should be 2, because the reflections model the layer. A blocked line loses `shadow_db` in all
/// and has K = 0.
///
/// Depths above the surface or below the bottom are moved to the surface or bottom.
class Propagation {
 public:
  Propagation(const WaterConfig& water, const PropagationConfig& propagation,
              LineOfSight line_of_sight = {});

  /// Same bits with the two points swapped.
  /// @param p_A_W, p_B_W [m, world axes] @param centre_khz of the band
  PathSum At(const Vec3<double>& p_A_W, const Vec3<double>& p_B_W, double centre_khz) const;

  /// Pressure of a tone relative to that at 1 m, the sum of all paths with their phases. The
  /// channel uses At: a modem's band is wide enough for phases to average out.
  std::complex<double> Tone(const Vec3<double>& p_A_W, const Vec3<double>& p_B_W, double khz) const;

  double SoundSpeed(double depth_m) const { return profile_.At(depth_m); }

 private:
  struct Geometry;
  Geometry Place(const Vec3<double>& p_A_W, const Vec3<double>& p_B_W) const;

  WaterConfig water_;
  PropagationConfig config_;
  SoundSpeedProfile profile_;
  LineOfSight line_of_sight_;
};

}  // namespace stg::acoustics

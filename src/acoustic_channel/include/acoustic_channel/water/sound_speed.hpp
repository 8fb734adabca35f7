#pragma once

#include "acoustic_channel/water/water_config.hpp"

namespace stg::acoustics {

/// Sound speed in sea water [m/s]: the nine-term equation of K. V. Mackenzie, J. Acoust. Soc. Am.
/// 70 (1981) 807. Valid from -2 to 30 degrees C, 25 to 40 psu, 0 to 8000 m.
/// @param temperature_c [degrees C] @param salinity_psu [psu] @param depth_m [m], down
double MackenzieSoundSpeed(double temperature_c, double salinity_psu, double depth_m);

/// Sound speed over depth as the section describes it. Rays are straight: the profile changes
/// travel times, not directions.
class SoundSpeedProfile {
 public:
  explicit SoundSpeedProfile(const WaterConfig& water) : water_(water) {}

  /// At this depth [m]; above the surface the surface's.
  double At(double depth_m) const;
  /// Mean of 1/c [s/m] over the depths between two; the same bits whichever of them is first.
  double MeanSlowness(double depth_a_m, double depth_b_m) const;

 private:
  WaterConfig water_;
};

}  // namespace stg::acoustics

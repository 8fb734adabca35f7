#include "acoustic_channel/water/sound_speed.hpp"

#include <algorithm>

namespace stg::acoustics {

double MackenzieSoundSpeed(double temperature_c, double salinity_psu, double depth_m) {
  const double T = temperature_c, S = salinity_psu - 35.0, D = depth_m;
  return 1448.96 + 4.591 * T - 5.304e-2 * T * T + 2.374e-4 * T * T * T + 1.340 * S + 1.630e-2 * D +
         1.675e-7 * D * D - 1.025e-2 * T * S - 7.139e-13 * T * D * D * D;
}

double SoundSpeedProfile::At(double depth_m) const {
  const double d = std::max(depth_m, 0.0);
  if (water_.sound_speed == WaterConfig::SoundSpeed::kMackenzie) {
    return MackenzieSoundSpeed(water_.temperature_c, water_.salinity_psu, d);
  }
  const auto& depths = water_.profile_depths_m;
  const auto& speeds = water_.profile_speeds_mps;
  if (d <= depths.front()) return speeds.front();
  for (std::size_t i = 1; i < depths.size(); ++i) {
    if (d > depths[i]) continue;
    const double share = (d - depths[i - 1]) / (depths[i] - depths[i - 1]);
    return speeds[i - 1] + share * (speeds[i] - speeds[i - 1]);
  }
  return speeds.back();
}

double SoundSpeedProfile::MeanSlowness(double depth_a_m, double depth_b_m) const {
  const double lo = std::min(depth_a_m, depth_b_m), hi = std::max(depth_a_m, depth_b_m);
  // Simpson's rule. One metre of depth changes c by less than a thousandth.
  if (hi - lo < 1.0) return 1.0 / At(0.5 * (lo + hi));
  constexpr int kHalves = 8;
  const double h = (hi - lo) / (2 * kHalves);
  double sum = 1.0 / At(lo) + 1.0 / At(hi);
  for (int i = 1; i < 2 * kHalves; ++i) sum += (i % 2 == 0 ? 2.0 : 4.0) / At(lo + i * h);
  return sum / (6 * kHalves);
}

}  // namespace stg::acoustics

#pragma once

#include <array>
#include <optional>

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel.physical.water`: properties of the water.
struct WaterConfig {
  enum class SoundSpeed { kMackenzie, kProfile };
  enum class Absorption { kThorp, kFrancoisGarrison };
  static constexpr std::size_t kKnots = 4;

  double surface_z_m = 0.0;  ///< z of the surface in world axes; depths count from here
  double depth_m = 1000.0;   ///< of the flat bottom below the surface
  double temperature_c = 14.0;
  double salinity_psu = 35.0;
  double ph = 8.0;
  SoundSpeed sound_speed = SoundSpeed::kMackenzie;
  /// Points of the profile: ascending depths, and the sound speed there; linear between, constant
  /// outside.
  std::array<double, kKnots> profile_depths_m{0.0, 20.0, 50.0, 100.0};
  std::array<double, kKnots> profile_speeds_mps{1500.0, 1500.0, 1500.0, 1500.0};
  Absorption absorption = Absorption::kThorp;
};

void Describe(WaterConfig* c, config::Table* t);
std::optional<config::Violation> FindConflict(const WaterConfig& c);

}  // namespace stg::acoustics

#pragma once

#include "acoustic_channel/water/water_config.hpp"

namespace stg::acoustics {

/// Absorption [dB/km] at f [kHz] by W. H. Thorp, in the form with the constant term (Urick 1983,
/// section 5.3): sea water of 4 degrees C near the surface, f >= 0.4 kHz.
double ThorpAbsorption(double khz);

/// Absorption [dB/km] at f [kHz] by R. E. Francois and G. R. Garrison, J. Acoust. Soc. Am. 72
/// (1982) 896 and 1879: boric acid, magnesium sulphate and pure water. Valid from 0.2 to 1000 kHz,
/// -2 to 30 degrees C, 30 to 40 psu, 0 to 7000 m.
/// @param sound_speed_mps at that depth [m/s]
double FrancoisGarrisonAbsorption(double khz, double temperature_c, double salinity_psu,
                                  double depth_m, double ph);

/// By the section's formula, at this depth [m].
double Absorption(const WaterConfig& water, double khz, double depth_m);

}  // namespace stg::acoustics

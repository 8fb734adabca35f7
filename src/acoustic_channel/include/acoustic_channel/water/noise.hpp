#pragma once

#include <optional>

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel.physical.noise`.
struct NoiseConfig {
  double shipping = 0.5;        ///< activity, 0 to 1
  double wind_mps = 5.0;        ///< at the surface
  double site_db = 0.0;         ///< flat density added to the formulas, re 1 uPa^2/Hz
  double own_db = 65.0;         ///< density at 1 kHz and 1 m/s at the vehicle's own receiver
  double own_slope_db = 60.0;   ///< per decade of speed
  double burst_db = 20.0;       ///< level by which a burst raises the ambient noise
  double burst_every_s = 0.0;   ///< mean time between bursts; 0: no bursts
  double burst_length_s = 0.5;  ///< mean
};

void Describe(NoiseConfig* c, config::Table* t);

/// Power spectral densities of ambient noise at f [kHz], dB re 1 uPa^2/Hz: the form that R. Coates
/// (Underwater Acoustic Systems, 1990) gives to the curves of G. M. Wenz (J. Acoust. Soc. Am. 34
/// (1962) 1936); about 0.01 to 100 kHz.
double TurbulenceNoise(double khz);
double ShippingNoise(double khz, double shipping);
double WindNoise(double khz, double wind_mps);
double ThermalNoise(double khz);
/// Sum of the powers of the four.
double AmbientNoise(double khz, double shipping, double wind_mps);

/// Density of a vehicle's own propulsion noise at its own receiver, dB re 1 uPa^2/Hz:
/// own_db + own_slope_db lg(v / 1 m/s) - 20 lg(f / 1 kHz), the power law of propeller noise over
/// speed and its fall of 6 dB an octave (D. Ross, Mechanics of Underwater Noise, 1976). At rest
/// there is none: -infinity.
double OwnNoise(const NoiseConfig& noise, double khz, double speed_mps);

/// Noise at a receiver.
class NoiseModel {
 public:
  explicit NoiseModel(const NoiseConfig& noise) : noise_(noise) {}

  /// Level in a band [dB re 1 uPa]: ambient (raised when a burst is on), site and own noise, each
  /// taken as flat over the band at its centre's value.
  /// @param speed_mps of the receiver through the water
  double BandLevelDb(double centre_khz, double bandwidth_khz, double speed_mps, bool burst) const;

 private:
  NoiseConfig noise_;
};

}  // namespace stg::acoustics

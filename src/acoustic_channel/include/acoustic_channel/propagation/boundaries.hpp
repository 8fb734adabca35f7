#pragma once

#include <complex>

/// Reflection coefficients of pressure at the two boundaries of the water, for a plane wave that
/// meets them at a grazing angle theta.
namespace stg::acoustics {

/// A pressure-release surface with waves: -exp(-2 (k sigma sin theta)^2), the coherent part of a
/// Gaussian rough surface (Rayleigh roughness; Jensen et al., Computational Ocean Acoustics, 2011,
/// section 1.6).
/// @param wave_number k [1/m] @param height_rms_m sigma [m]
double SurfaceReflection(double sin_theta, double wave_number, double height_rms_m);

/// Rayleigh's coefficient of a fluid half space (Jensen et al., Eq. 1.57, with a complex speed of
/// sound for the loss). Phases for a time factor exp(-i omega t).
/// @param density_ratio, speed_ratio bottom to water @param loss_db per wavelength in the bottom
std::complex<double> BottomReflection(double sin_theta, double density_ratio, double speed_ratio,
                                      double loss_db);

}  // namespace stg::acoustics

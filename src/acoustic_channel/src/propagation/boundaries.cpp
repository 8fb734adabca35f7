#include "acoustic_channel/propagation/boundaries.hpp"

#include <cmath>

namespace stg::acoustics {

double SurfaceReflection(double sin_theta, double wave_number, double height_rms_m) {
  const double roughness = wave_number * height_rms_m * sin_theta;
  return -std::exp(-2.0 * roughness * roughness);
}

std::complex<double> BottomReflection(double sin_theta, double density_ratio, double speed_ratio,
                                      double loss_db) {
  // The loss per wavelength is the imaginary part of the index of refraction: 2 pi 20 lg e dB.
  constexpr double kDbPerUnit = 54.575054;
  const std::complex<double> index = std::complex<double>(1.0, loss_db / kDbPerUnit) / speed_ratio;
  const double cos2 = 1.0 - sin_theta * sin_theta;
  const std::complex<double> root = std::sqrt(index * index - cos2);
  const double across = density_ratio * sin_theta;
  return (across - root) / (across + root);
}

}  // namespace stg::acoustics

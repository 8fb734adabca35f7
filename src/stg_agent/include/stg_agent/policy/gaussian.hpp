#pragma once

#include <cmath>

#include "auv_common/numbers/random.hpp"

/// The exploring policy of Eq. 37: a Gaussian around the mean, with a standard deviation of its own
/// for each action that does not depend on the observation.
namespace stg::agent {

/// log sqrt(2 pi)
inline constexpr float kHalfLogTwoPi = 0.918938533F;
/// log sqrt(2 pi e): entropy of a Gaussian of deviation 1.
inline constexpr double kHalfLogTwoPiE = 1.4189385332046727;

/// Draws an action: adds noise to the mean that `action` holds.
/// @param log_std [size]
/// @return natural log of the density at the drawn action
inline float SampleGaussian(const float* log_std, int size, Random* random, float* action) {
  float log_density = 0.0F;
  for (int k = 0; k < size; ++k) {
    const float z = static_cast<float>(random->Normal());
    action[k] += std::exp(log_std[k]) * z;
    log_density -= 0.5F * z * z + log_std[k] + kHalfLogTwoPi;
  }
  return log_density;
}

/// Natural log of the density at an action. @param mean, log_std, action [size]
inline double GaussianLogDensity(const float* mean, const float* log_std, const float* action,
                                 int size) {
  double sum = 0.0;
  for (int k = 0; k < size; ++k) {
    const double log_sigma = static_cast<double>(log_std[k]);
    const double miss = static_cast<double>(action[k]) - static_cast<double>(mean[k]);
    const double z = miss * std::exp(-log_sigma);
    sum -= 0.5 * z * z + log_sigma + static_cast<double>(kHalfLogTwoPi);
  }
  return sum;
}

}  // namespace stg::agent

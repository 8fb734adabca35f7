#pragma once

#include "acoustic_channel/models/extended_config.hpp"
#include "auv_common/numbers/vector.hpp"

/// Link quality of the paper, for one link (double) or kLanes links (Pack).
namespace stg::acoustics {

/// What a propagation model says of a link.
template <class T>
struct LinkValues {
  T loss;     ///< probability that a packet is lost
  T quality;  ///< [0, 1]
};

/// Normalised link availability q of Eq. 5: 1 at zero distance, 0 at R_c [m] and beyond.
template <class T>
T RangeQuality(const T& d, double R_c) {
  return Clip(T(1.0) - d / T(R_c), 0.0, 1.0);
}

/// Packet loss probability at distance d [m]: 1 - (1 - p0) exp(-(d / d_loss)^2).
///
/// The paper leaves p_loss of Eq. 6 open; this one is p0 at zero distance, grows monotonically
/// and tends to 1.
template <class T>
T LossProbability(const T& d, const ExtendedConfig& config) {
  const T x = d * T(1.0 / config.loss_distance_m);
  return T(1.0) - T(1.0 - config.loss_probability) * Exp(-(x * x));
}

/// Extended link quality of Eq. 6: attenuation, packet loss and freshness at distance d [m] and
/// age of information age_s [s], whatever the range.
template <class T>
T ExtendedQuality(const T& d, const T& age_s, const ExtendedConfig& config) {
  return (T(1.0) - LossProbability(d, config)) *
         Exp(-(d * T(config.attenuation_per_m) + age_s * T(1.0 / config.freshness_s)));
}

}  // namespace stg::acoustics

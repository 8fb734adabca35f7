#pragma once

#include "acoustic_channel/models/extended_config.hpp"
#include "acoustic_channel/models/link_values.hpp"
#include "auv_common/numbers/lanes.hpp"

namespace stg::acoustics {

struct ChannelConfig;

/// Packet loss probability at distance d [m]: 1 - (1 - p0) exp(-(d / d_loss)^2).
///
/// The paper leaves p_loss of Eq. 6 open; this one is p0 at zero distance, grows monotonically
/// and tends to 1.
template <class T>
T LossProbability(const T& d, const ExtendedConfig& config) {
  const T x = d * T(1.0 / config.loss_distance_m);
  return T(1.0) - T(1.0 - config.loss_probability) * Exp(-(x * x));
}

/// Extended link quality of Eq. 6 without a limit of the range: attenuation, packet loss and
/// freshness at distance d [m] and age of information age_s [s].
template <class T>
T ExtendedQuality(const T& d, const T& age_s, const ExtendedConfig& config) {
  return (T(1.0) - LossProbability(d, config)) *
         Exp(-(d * T(config.attenuation_per_m) + age_s * T(1.0 / config.freshness_s)));
}

/// Eq. 6: attenuation, random loss, propagation delay, freshness.
class ExtendedModel {
 public:
  explicit ExtendedModel(const ChannelConfig& config);

  template <class T>
  T DelayS(const T& d) const {
    return d / T(config_.sound_speed_mps);
  }
  template <class T>
  LinkValues<T> At(const T& d, const T& age_s) const {
    return {LossProbability(d, config_), ExtendedQuality(d, age_s, config_)};
  }
  bool Reaches(double d) const { return d <= config_.max_range_m; }
  bool ages() const { return true; }
  double freshness_s() const { return config_.freshness_s; }

 private:
  ExtendedConfig config_;
};

}  // namespace stg::acoustics

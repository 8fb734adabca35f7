#pragma once

#include "acoustic_channel/link/link_quality.hpp"
#include "acoustic_channel/models/extended_config.hpp"

namespace stg::acoustics {

struct ChannelConfig;

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

#pragma once

#include "acoustic_channel/link/link_quality.hpp"
#include "acoustic_channel/models/range_config.hpp"

namespace stg::acoustics {

struct ChannelConfig;

/// Eq. 5: everything arrives at once and nothing is lost where the quality is above zero.
class RangeModel {
 public:
  explicit RangeModel(const ChannelConfig& config);

  template <class T>
  T DelayS(const T& /*d*/) const {
    return T(0.0);
  }
  template <class T>
  LinkValues<T> At(const T& d, const T& /*age_s*/) const {
    return {T(0.0), RangeQuality(d, range_m_)};
  }
  bool Reaches(double d) const { return RangeQuality(d, range_m_) > 0.0; }
  bool ages() const { return false; }
  double freshness_s() const { return freshness_s_; }

 private:
  double range_m_, freshness_s_;
};

}  // namespace stg::acoustics

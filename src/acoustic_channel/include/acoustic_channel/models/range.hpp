#pragma once

#include "acoustic_channel/models/link_values.hpp"
#include "acoustic_channel/models/range_config.hpp"
#include "auv_common/numbers/lanes.hpp"

namespace stg::acoustics {

struct ChannelConfig;

/// Normalised link availability q of Eq. 5: 1 at zero distance, 0 at R_c [m] and beyond.
template <class T>
T RangeQuality(const T& d, double R_c) {
  return Clip(T(1.0) - d / T(R_c), 0.0, 1.0);
}

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

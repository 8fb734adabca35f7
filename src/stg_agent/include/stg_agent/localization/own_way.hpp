#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "auv_common/config/run_config.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "stg_agent/localization/localizer.hpp"

namespace stg::agent {

/// Reckoned positions and attitudes of an AUV at its last decisions.
class OwnWay {
 public:
  explicit OwnWay(const RunConfig& run)
      : places_(static_cast<std::size_t>(
            std::clamp(static_cast<int>(kKept_s / run.decision_dt_s()), 4, kMost))),
        period_(run.decision_period()) {}

  void Clear() { count_ = 0; }
  void Add(TimeNs now, const OwnReckoning& own) { places_[count_++ % places_.size()] = {now, own}; }

  /// Position at a time, on the line between two decisions; false: the time is not between two
  /// stored ones.
  bool At(TimeNs t, Vec3<double>* p) const {
    const std::size_t kept = std::min(count_, places_.size());
    for (std::size_t k = 0; k + 1 < kept; ++k) {
      const Place& b = places_[(count_ - 1 - k) % places_.size()];
      const Place& a = places_[(count_ - 2 - k) % places_.size()];
      if (t < a.at || t > b.at) continue;
      const double s = Seconds(t - a.at) / Seconds(b.at - a.at);
      *p = a.own.p_WB * (1.0 - s) + b.own.p_WB * s;
      return true;
    }
    return false;
  }

  /// Attitude at the last decision before a time; false: it is not stored.
  bool Attitude(TimeNs t, Mat3<double>* R_WB) const {
    const std::size_t kept = std::min(count_, places_.size());
    for (std::size_t k = 0; k < kept; ++k) {
      const Place& place = places_[(count_ - 1 - k) % places_.size()];
      if (place.at >= t) continue;
      if (t - place.at > period_) return false;
      *R_WB = RotationOf(place.own.q_WB);
      return true;
    }
    return false;
  }

 private:
  static constexpr double kKept_s = 20.0;
  static constexpr int kMost = 256;
  struct Place {
    TimeNs at = 0;
    OwnReckoning own;
  };

  std::vector<Place> places_;  // a ring
  std::size_t count_ = 0;
  TimeNs period_;  // between two decisions
};

}  // namespace stg::agent

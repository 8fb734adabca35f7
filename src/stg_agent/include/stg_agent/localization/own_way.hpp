#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "auv_common/config/run_config.hpp"
#include "auv_common/numbers/vector.hpp"

namespace stg::agent {

/// Reckoned positions of an AUV at its last decisions.
class OwnWay {
 public:
  explicit OwnWay(const RunConfig& run)
      : places_(static_cast<std::size_t>(
            std::clamp(static_cast<int>(kKept_s / run.decision_dt_s()), 4, kMost))) {}

  void Clear() { count_ = 0; }
  void Add(TimeNs now, const Vec3<double>& p) { places_[count_++ % places_.size()] = {now, p}; }

  /// Position at a time, on the line between two decisions; false: the time is not between two
  /// stored ones.
  bool At(TimeNs t, Vec3<double>* p) const {
    const std::size_t kept = std::min(count_, places_.size());
    for (std::size_t k = 0; k + 1 < kept; ++k) {
      const Place& b = places_[(count_ - 1 - k) % places_.size()];
      const Place& a = places_[(count_ - 2 - k) % places_.size()];
      if (t < a.at || t > b.at) continue;
      const double s = Seconds(t - a.at) / Seconds(b.at - a.at);
      *p = a.p * (1.0 - s) + b.p * s;
      return true;
    }
    return false;
  }

 private:
  static constexpr double kKept_s = 20.0;
  static constexpr int kMost = 256;
  struct Place {
    TimeNs at = 0;
    Vec3<double> p;
  };

  std::vector<Place> places_;  // a ring
  std::size_t count_ = 0;
};

}  // namespace stg::agent

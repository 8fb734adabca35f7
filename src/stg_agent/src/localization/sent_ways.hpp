#pragma once

#include <array>
#include <cstddef>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

namespace stg::agent {

/// The last reported positions of one member of the network.
class SentWay {
 public:
  static constexpr TimeNs kLongestGap = 30'000'000'000;

  struct Point {
    TimeNs generation = -1;  ///< time of position and velocity
    TimeNs transmit = -1;    ///< when the transmission of their packet began
    Vec3<double> p, v;
  };

  void Clear() { *this = SentWay(); }
  bool empty() const { return count_ == 0; }
  const Point& newest() const { return At(count_ - 1); }

  /// Adds a point; returns false, without a change, if it is not newer than the newest.
  bool Add(const Point& point) {
    if (count_ > 0 && point.generation <= newest().generation) return false;
    if (count_ == kMost) {
      first_ = (first_ + 1) % kMost;
      --count_;
    }
    points_[static_cast<std::size_t>((first_ + count_) % kMost)] = point;
    ++count_;
    return true;
  }

  /// Position and time of the transmission that began nearest to a time; false: that packet was not
  /// received.
  bool AtPacket(TimeNs near, TimeNs tolerance, TimeNs* transmit, Vec3<double>* p) const {
    for (int k = count_ - 1; k >= 0; --k) {
      const Point& point = At(k);
      const TimeNs off = point.transmit - near;
      if (off > tolerance || off < -tolerance) continue;
      *transmit = point.transmit;
      *p = point.p + point.v * Seconds(point.transmit - point.generation);
      return true;
    }
    return false;
  }

  /// Position between two packets: the cubic through both positions with both velocities.
  bool Between(TimeNs t, Vec3<double>* p) const {
    for (int k = count_ - 1; k > 0; --k) {
      const Point &a = At(k - 1), &b = At(k);
      if (t < a.generation || t > b.generation) continue;
      const TimeNs gap = b.generation - a.generation;
      if (gap > kLongestGap) return false;
      const double T = Seconds(gap), s = Seconds(t - a.generation) / T, r = 1.0 - s;
      *p = a.p * (r * r * (1.0 + 2.0 * s)) + a.v * (r * r * s * T) +
           b.p * (s * s * (3.0 - 2.0 * s)) - b.v * (s * s * r * T);
      return true;
    }
    return false;
  }

 private:
  static constexpr int kMost = 16;
  const Point& At(int k) const { return points_[static_cast<std::size_t>((first_ + k) % kMost)]; }

  int first_ = 0, count_ = 0;
  std::array<Point, kMost> points_{};
};

}  // namespace stg::agent

#pragma once

#include <chrono>

namespace stg::learn {

/// Wall-clock time [s], only for reports and never for computations.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// Time since the start or the last lap [s].
  double Lap() {
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double> lap = now - lap_;
    lap_ = now;
    return lap.count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), lap_ = start_;
};

}  // namespace stg::learn

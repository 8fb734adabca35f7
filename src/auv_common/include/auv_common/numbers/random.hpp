#pragma once

#include <Random123/philox.h>

#include <cmath>
#include <cstdint>

/// Counter-based random numbers (Philox 4x32-10, Salmon et al. 2011).
///
/// A draw is a pure function of (seed, stream, episode, step, index). So results depend neither on
/// the number of threads nor on the timing of messages.
namespace stg {

/// One independent stream for each use. Never reuse a value of a removed stream.
enum class Stream : std::uint32_t {
  kReset = 1,
  kTarget = 2,
  kDetection = 3,
  kDisturbance = 4,
  kChannel = 5,
  kCue = 6,
  kPolicy = 7,
  kShuffle = 8,
  kInit = 9,
  kMediumAccess = 10,
  kShadowing = 20,
  kFading = 21,
  kBurst = 22,
  kTraffic = 23,
  kClock = 25,
  kReception = 26,
  kTiming = 27,
  kReplay = 40,
  kTargetNoise = 41,
  kNavigationStart = 50,
  kNavigation = 51,
  kMeasurement = 52,
  kFalseAlarm = 53,
  kStation = 54,
  kCurrent = 55,
  kPing = 56,
  kBearing = 57,
};

/// The sequence of draws of one key (seed, stream, episode, step, index).
class Random {
 public:
  Random(std::uint64_t seed, Stream stream, std::uint32_t episode, std::uint32_t step,
         std::uint32_t index)
      : key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}},
        counter_{{0, (static_cast<std::uint32_t>(stream) << 24) ^ index, episode, step}} {}

  /// 32 random bits.
  std::uint32_t Bits() {
    if (used_ == 4) {
      block_ = r123::Philox4x32()(counter_, key_);
      ++counter_[0];
      used_ = 0;
    }
    return block_[static_cast<std::size_t>(used_++)];
  }

  /// Uniform in [0, 1), 53 bits.
  double Uniform() {
    const std::uint64_t hi = Bits() >> 5;
    const std::uint64_t lo = Bits() >> 6;
    return static_cast<double>(hi * 67108864ULL + lo) * (1.0 / 9007199254740992.0);
  }
  double Uniform(double lo, double hi) { return lo + (hi - lo) * Uniform(); }

  /// Standard normal (Box-Muller; both halves are used).
  double Normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double u = 1.0 - Uniform();  // (0, 1]
    const double v = Uniform();
    const double r = std::sqrt(-2.0 * std::log(u));
    const double angle = 6.283185307179586476925 * v;
    spare_ = r * std::sin(angle);
    has_spare_ = true;
    return r * std::cos(angle);
  }

 private:
  r123::Philox4x32::key_type key_;
  r123::Philox4x32::ctr_type counter_;
  r123::Philox4x32::ctr_type block_{};
  int used_ = 4;
  bool has_spare_ = false;
  double spare_ = 0.0;
};

}  // namespace stg

#pragma once

#include <cstdint>
#include <vector>

#include "acoustic_channel/water/noise.hpp"
#include "auv_common/time.hpp"

namespace stg::acoustics {

/// Bursts of noise, each receiver its own: a Markov process in continuous time with two states,
/// quiet for `burst_every_s` and loud for `burst_length_s` on average, both exponential. An episode
/// begins quiet at time 0. The course depends on seed, episode and node only, not on calls.
class Bursts {
 public:
  /// [begin, end) in which nothing changes.
  struct Span {
    bool loud = false;
    TimeNs begin = 0, end = 0;
  };

  Bursts(const NoiseConfig& config, int nodes);

  void Reset(std::uint64_t seed, std::uint32_t episode);

  /// The span around t >= 0 at this node; without bursts one that never ends.
  Span At(int node, TimeNs t);

 private:
  struct Cursor {
    std::uint32_t index = 0;  ///< of the span, even ones are quiet
    TimeNs begin = 0, end = 0;
  };
  TimeNs Duration(int node, std::uint32_t index) const;

  double every_s_, length_s_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  std::vector<Cursor> cursors_;
};

}  // namespace stg::acoustics

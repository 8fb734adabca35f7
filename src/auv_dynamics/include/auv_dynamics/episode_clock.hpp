#pragma once

#include <array>
#include <cstdint>

#include "auv_common/numbers/lanes.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::dynamics {

/// Time of one lane in its run. A random draw depends only on this clock, a stream and an index.
struct EpisodeClock {
  std::uint64_t seed = 0;
  std::uint32_t episode = 0;
  std::uint32_t step = 0;  ///< physics steps since the start of the episode

  /// Random numbers of this step.
  Random Draw(Stream stream, std::uint32_t index) const { return DrawAt(stream, step, index); }
  /// Random numbers of another count than physics steps, such as a time slot or the n-th waypoint.
  Random DrawAt(Stream stream, std::uint32_t count, std::uint32_t index) const {
    return Random(seed, stream, episode, count, index);
  }
};
using EpisodeClocks = std::array<EpisodeClock, kLanes>;

}  // namespace stg::dynamics

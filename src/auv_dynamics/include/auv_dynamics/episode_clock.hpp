#pragma once

#include <array>
#include <cstdint>

#include "auv_common/numbers/lanes.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::dynamics {

/// Where one lane stands in its run. With a stream and an index this is all that a draw of a random
/// number depends on.
struct EpisodeClock {
  std::uint64_t seed = 0;
  std::uint32_t episode = 0;
  std::uint32_t step = 0;  ///< physics steps since the start of the episode

  /// Numbers of this step.
  Random Draw(Stream stream, std::uint32_t index) const { return DrawAt(stream, step, index); }
  /// Numbers of another count than physics steps: of a slot of time, of the n-th waypoint.
  Random DrawAt(Stream stream, std::uint32_t count, std::uint32_t index) const {
    return Random(seed, stream, episode, count, index);
  }
};
using EpisodeClocks = std::array<EpisodeClock, kLanes>;

}  // namespace stg::dynamics

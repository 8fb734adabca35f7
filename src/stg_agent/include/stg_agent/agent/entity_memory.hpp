#pragma once

#include <array>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"
#include "auv_dynamics/measurements.hpp"

namespace stg::agent {

using dynamics::kMostTargets;

/// Size of a command. Actions with fewer numbers use the first ones.
inline constexpr int kCommandNumbers = 5;

/// The noise of an AUV's exploration in its last command: for each number of the command an
/// autoregression of order one with variance 1, which is an Ornstein-Uhlenbeck process at the times
/// of the commands.
struct CommandNoise {
  bool begun = false;  ///< false: the next command draws a first value, of variance 1
  std::array<float, kCommandNumbers> values{};
};

/// What the agent keeps between decisions for the entities, and the present command. A new episode
/// clears it.
struct EntityMemory {
  TimeNs now = 0;               ///< time of the last Observe
  double position_std_m = 0.0;  ///< stated by the navigation, for the own position
  /// Time of the newest own detection of each target; -1: none.
  std::array<TimeNs, kMostTargets> own_detection = NoDetections();
  int follow = -1;            ///< target to follow from the next decision on; -1: the present one
  TimeNs followed_since = 0;  ///< since when it has followed the present target
  bool assigned = false;      ///< a law has chosen the target
  TimeNs assigned_time = 0;   ///< time of the last choice
  bool commanded = false;     ///< there is a command
  TimeNs command_time = 0;
  std::array<float, kCommandNumbers> command{};  ///< in [-1, 1]
  bool search = false;      ///< the command is to search, although the target is estimated
  Vec3<double> velocity_W;  ///< desired velocity of a command of `course3`, world axes [m/s]
  CommandNoise noise;       ///< of the exploration; unused without one

  bool ranged(int target) const { return own_detection[static_cast<std::size_t>(target)] >= 0; }

  static constexpr std::array<TimeNs, kMostTargets> NoDetections() {
    std::array<TimeNs, kMostTargets> none{};
    for (TimeNs& t : none) t = -1;
    return none;
  }
};

}  // namespace stg::agent

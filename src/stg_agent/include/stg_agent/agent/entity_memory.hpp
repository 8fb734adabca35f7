#pragma once

#include <array>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

namespace stg::agent {

/// No scenario has more targets.
inline constexpr int kMostTargets = 16;

/// Numbers of a command to the autopilot's guidance; other action interfaces use the first ones.
inline constexpr int kCommandNumbers = 5;

/// What an AUV remembers from decision to decision for its entities, and the command that it flies
/// by until the next one. Part of the agent: a new episode forgets it.
struct EntityMemory {
  TimeNs now = 0;               ///< of the last Observe
  double position_std_m = 0.0;  ///< of the own position, as navigation states it
  /// Of each target: the newest own detection; -1: there was none.
  std::array<TimeNs, kMostTargets> own_detection = NoDetections();
  int follow = -1;            ///< the target to follow from the next decision on; -1: the same
  TimeNs followed_since = 0;  ///< of the target that it follows
  bool assigned = false;      ///< a law has chosen which target to follow
  TimeNs assigned_time = 0;   ///< when it did so last
  bool commanded = false;     ///< there is a command
  TimeNs command_time = 0;
  std::array<float, kCommandNumbers> command{};  ///< in [-1, 1]
  bool search = false;      ///< the command is to search, although there is a belief of the target
  Vec3<double> velocity_W;  ///< what a command of `course3` stands for, world axes [m/s]

  bool ranged(int target) const { return own_detection[static_cast<std::size_t>(target)] >= 0; }

  static constexpr std::array<TimeNs, kMostTargets> NoDetections() {
    std::array<TimeNs, kMostTargets> none{};
    for (TimeNs& t : none) t = -1;
    return none;
  }
};

}  // namespace stg::agent

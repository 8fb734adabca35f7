#pragma once

#include <array>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

namespace stg::agent {

/// Numbers of a command to the autopilot's guidance; other action interfaces use the first ones.
inline constexpr int kCommandNumbers = 5;

/// What an AUV remembers from decision to decision for its entities, and the command that it flies
/// by until the next one. Part of the agent: a new episode forgets it.
struct EntityMemory {
  TimeNs now = 0;               ///< of the last Observe
  double position_std_m = 0.0;  ///< of the own position, as navigation states it
  bool ranged = false;          ///< there was an own detection of the target
  TimeNs own_detection = 0;     ///< the newest one
  bool commanded = false;       ///< there is a command
  TimeNs command_time = 0;
  std::array<float, kCommandNumbers> command{};  ///< in [-1, 1]
  bool search = false;      ///< the command is to search, although there is a belief of the target
  Vec3<double> velocity_W;  ///< what a command of `course3` stands for, world axes [m/s]
};

}  // namespace stg::agent

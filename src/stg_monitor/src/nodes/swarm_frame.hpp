#pragma once

#include <auv_msgs/LinkStates.h>
#include <auv_msgs/SwarmState.h>
#include <auv_msgs/TaskState.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stg::nodes {

/// All messages of the swarm with one stamp. A null pointer: not here (yet).
struct SwarmFrame {
  explicit SwarmFrame(int agents) : tasks(static_cast<std::size_t>(agents)) {}

  auv_msgs::SwarmState::ConstPtr truth;              ///< what no step can be judged without
  std::vector<auv_msgs::TaskState::ConstPtr> tasks;  ///< [agents]
  auv_msgs::LinkStates::ConstPtr links;              ///< up to here; the channel tells now and then

  /// Everything is here.
  bool Complete() const {
    const auto here = [](const auto& message) { return message != nullptr; };
    return truth && std::all_of(tasks.begin(), tasks.end(), here);
  }
};

}  // namespace stg::nodes

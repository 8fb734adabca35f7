#pragma once

#include <auv_msgs/LinkStates.h>
#include <auv_msgs/SwarmState.h>
#include <auv_msgs/TaskState.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stg::nodes {

/// All messages of the swarm with the same stamp. Null: the message has not arrived.
struct SwarmFrame {
  explicit SwarmFrame(int agents) : tasks(static_cast<std::size_t>(agents)) {}

  auv_msgs::SwarmState::ConstPtr truth;              ///< no step can be judged without it
  std::vector<auv_msgs::TaskState::ConstPtr> tasks;  ///< [agents]
  /// Links up to this step. The channel does not send them at every step.
  auv_msgs::LinkStates::ConstPtr links;

  /// True if all messages are here. Links are not required.
  bool Complete() const {
    const auto here = [](const auto& message) { return message != nullptr; };
    return truth && std::all_of(tasks.begin(), tasks.end(), here);
  }
};

}  // namespace stg::nodes

#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <string>

#include "auv_dynamics/error.hpp"

namespace stg {

/// Low latency for small messages: every subscription asks for it.
inline ros::TransportHints NoDelay() { return ros::TransportHints().tcpNoDelay(); }

/// Handles incoming messages as they come, for at most `wait_s` seconds of wall time when none is
/// there. Single-threaded: nodes need no locks.
inline void HandleMessages(double wait_s) {
  ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(wait_s));
}

/// A node's main: Node has a constructor without arguments that may throw UserError, and Spin().
template <class Node>
int RunNode(int argc, char** argv, const std::string& name) {
  ros::init(argc, argv, name);
  // Outlives the node: with the last handle ROS ends, and a fatal message would go nowhere.
  ros::NodeHandle keeps_ros_running;
  try {
    Node node;
    node.Spin();
  } catch (const UserError& error) {
    ROS_FATAL("%s", error.what());
    return 2;
  }
  return 0;
}

}  // namespace stg

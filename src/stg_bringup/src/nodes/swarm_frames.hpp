#pragma once

#include <auv_msgs/SwarmState.h>
#include <auv_msgs/TaskState.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/time.h>

#include <array>
#include <map>
#include <vector>

#include "auv_dynamics/measurements.hpp"
#include "marl_trainer/scenario/scenario.hpp"

namespace stg::nodes {

/// All messages of the swarm with one stamp. A null pointer: not here (yet).
struct SwarmFrame {
  auv_msgs::SwarmState::ConstPtr truth;              ///< what no step can be judged without
  std::vector<auv_msgs::TaskState::ConstPtr> tasks;  ///< [agents]
  std::vector<geometry_msgs::WrenchStamped::ConstPtr> wrenches;  ///< [agents]
  ros::WallTime opened;

  /// Everything is here.
  bool Complete() const;
};

/// Sorts messages of many topics by stamp and gives frames in order of time.
class SwarmFrames {
 public:
  explicit SwarmFrames(int agents);

  /// The frame of a stamp, or null when it is older than one already taken.
  SwarmFrame* At(const ros::Time& stamp);

  /// The oldest frame when it is complete, or when it is `patience_s` old on the wall clock and a
  /// later one is there; false: wait.
  bool Take(double patience_s, SwarmFrame* frame);

 private:
  std::size_t agents_;
  ros::Time taken_;
  std::map<ros::Time, SwarmFrame> frames_;
};

}  // namespace stg::nodes

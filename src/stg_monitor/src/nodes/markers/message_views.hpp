#pragma once

#include <auv_msgs/TargetDetection.h>
#include <nav_msgs/Odometry.h>

#include "shapes/swarm_view.hpp"

/// From messages to what is drawn of them.
namespace stg::nodes {

bool Finite(const geometry_msgs::Point& p);

/// A position as measured is a direction and a distance.
DetectionView DetectionOf(const auv_msgs::TargetDetection& message);

/// World axes: nav_msgs has the twist in the child frame.
geometry_msgs::Vector3 VelocityOf(const nav_msgs::Odometry& message);

}  // namespace stg::nodes

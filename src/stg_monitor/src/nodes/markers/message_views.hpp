#pragma once

#include <auv_msgs/TargetDetection.h>
#include <nav_msgs/Odometry.h>

#include "shapes/swarm_view.hpp"

/// Conversions from messages to the data that is drawn.
namespace stg::nodes {

bool Finite(const geometry_msgs::Point& p);

/// A measured position is converted to a direction and a distance.
DetectionView DetectionOf(const auv_msgs::TargetDetection& message);

/// In world axes: nav_msgs has the twist in the child frame.
geometry_msgs::Vector3 VelocityOf(const nav_msgs::Odometry& message);

}  // namespace stg::nodes

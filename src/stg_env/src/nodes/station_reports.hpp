#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>

#include <cstddef>
#include <string>
#include <vector>

#include "auv_common/nodes/conversions.hpp"
#include "auv_common/nodes/topics.hpp"
#include "stg_agent/nodes/topics.hpp"
#include "stg_agent/stations/station_channel.hpp"

namespace stg::nodes {

/// Publishes the true positions of beacons and surface craft at each step, for displays:
/// /station_<k>/odom, in the frame `world`.
class StationReports : public agent::StationObserver {
 public:
  void OnStation(int station, TimeNs /*t*/, const agent::Station& state) override {
    const auto k = static_cast<std::size_t>(station);
    while (publishers_.size() <= k) publishers_.emplace_back();
    if (!publishers_[k]) {
      publishers_[k] =
          ros::NodeHandle().advertise<nav_msgs::Odometry>(topics::StationOdom(station), 1, true);
    }
    nav_msgs::Odometry m;
    m.header.stamp = ros::Time::now();
    m.header.frame_id = frames::kWorld;
    m.child_frame_id = "station_" + std::to_string(station);
    SetVector(state.p_W(), &m.pose.pose.position);
    m.pose.pose.orientation.w = 1.0;
    SetVector(state.v_W(), &m.twist.twist.linear);
    publishers_[k].publish(m);
  }

 private:
  std::vector<ros::Publisher> publishers_;
};

}  // namespace stg::nodes

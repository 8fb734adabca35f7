#pragma once

#include <auv_msgs/SensorFrame.h>
#include <auv_msgs/SwarmDetections.h>
#include <auv_msgs/SwarmState.h>
#include <auv_msgs/TargetDetection.h>
#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <vector>

#include "auv_common/nodes/on_demand.hpp"
#include "auv_dynamics/world/world.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace stg::nodes {

/// Publishes the state of lane 0 of a world.
class WorldPublisher {
 public:
  /// @param display_rate_hz largest rate, per second of wall time, of transforms and of detections
  /// for displays, and a tenth of the largest rate of /clock. No step waits for these messages.
  WorldPublisher(int agents, const dynamics::TargetConfig& target, double display_rate_hz);

  /// Sets the wrenches on the AUVs in the step that ends at the next PublishSensors, which of them
  /// were commanded for it, and whether the acoustic channel had closed it.
  void SetWrenches(const std::vector<dynamics::Wrench<double>>& wrenches,
                   const std::vector<std::uint8_t>& fresh, bool channel_fresh);

  /// The same for vehicles with other actuators: shares of their limits, kWrenchSize for each AUV.
  void SetEfforts(const std::vector<double>& efforts, const std::vector<std::uint8_t>& fresh,
                  bool channel_fresh);

  /// Publishes the AUVs' navigation between two decisions, for their autopilots.
  void PublishNavigation(const dynamics::World& world, TimeNs start);

  /// Publishes the sensor data of the AUVs at decision `step` of `episode`. Step 0 was at clock
  /// time `start` [ns].
  void PublishSensors(const dynamics::World& world, TimeNs start, std::uint32_t episode,
                      std::uint32_t step);

  /// Publishes the true states of all at the decision of the last PublishSensors.
  void PublishSwarm();

  /// Publishes data that only observers need, of the same decision: targets, detections, transforms
  /// and the clock.
  void PublishViews(const dynamics::World& world, TimeNs start);

 private:
  struct AuvTopics {
    ros::Publisher frame;
    auv_msgs::SensorFrame frame_message;
    dynamics::NavState navigation;
    auv_msgs::TargetDetection last_detection;
    OnDemand<nav_msgs::Odometry> odometry;
    OnDemand<auv_msgs::TargetDetection> detection;
  };
  void Advertise();
  static void SetNavigationOf(const dynamics::World& world, TimeNs start, int i, AuvTopics* auv);
  void SetFrame(const dynamics::World& world, TimeNs start, int i, AuvTopics* auv) const;
  void SetDetections(const dynamics::World& world, TimeNs now, int i,
                     auv_msgs::SensorFrame* m) const;
  void PublishClock(TimeNs now);
  void PublishDetections(TimeNs now);
  bool SetNewDetections(auv_msgs::SwarmDetections* message) const;
  void PublishFrames(TimeNs now);
  void SendWorldNed();

  dynamics::TargetConfig target_;
  double display_period_s_;
  std::uint64_t run_;  ///< id of this run
  ros::WallTime clock_sent_, frames_sent_, detections_sent_;
  ros::Time detections_until_;  ///< stamp of the newest detection that was sent to displays
  std::vector<AuvTopics> auvs_;
  std::vector<OnDemand<nav_msgs::Odometry>> targets_;
  std::vector<nav_msgs::Odometry> target_messages_;
  auv_msgs::SwarmState swarm_message_;
  OnDemand<auv_msgs::SwarmDetections> detections_;
  ros::Publisher swarm_, clock_, scenario_topic_;
  tf2_ros::TransformBroadcaster frames_;
  tf2_ros::StaticTransformBroadcaster static_frames_;
  std::vector<geometry_msgs::TransformStamped> transforms_;
};

}  // namespace stg::nodes

#include "world_publisher.hpp"

#include <rosgraph_msgs/Clock.h>
#include <std_msgs/String.h>

#include <cmath>

#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kSentQueue = 100;

geometry_msgs::TransformStamped TransformOf(const nav_msgs::Odometry& m) {
  geometry_msgs::TransformStamped t;
  t.header = m.header;
  t.child_frame_id = m.child_frame_id;
  t.transform.translation.x = m.pose.pose.position.x;
  t.transform.translation.y = m.pose.pose.position.y;
  t.transform.translation.z = m.pose.pose.position.z;
  t.transform.rotation = m.pose.pose.orientation;
  return t;
}

}  // namespace

WorldPublisher::WorldPublisher(const dynamics::WorldConfig& scenario, double display_rate_hz)
    : scenario_(scenario), display_period_s_(1.0 / display_rate_hz) {
  ros::NodeHandle node;
  for (int i = 0; i < scenario_.agents; ++i) {
    AuvTopics auv;
    auv.odometry =
        node.advertise<nav_msgs::Odometry>(topics::AuvTopic(i, topics::kOdom), kSentQueue, true);
    auv.detection = node.advertise<auv_msgs::TargetDetection>(
        topics::AuvTopic(i, topics::kTargetDetection), kSentQueue, true);
    auv.sync = node.advertise<auv_msgs::SensorSync>(topics::AuvTopic(i, topics::kSensorSync),
                                                    kSentQueue, true);
    auv.odometry_message.header.frame_id = frames::kWorld;
    auv.odometry_message.child_frame_id = frames::Body(i);
    auv.sync_message.header.frame_id = frames::Body(i);
    auvs_.push_back(auv);
  }
  // roscpp sends in the order of these lines: who decides is served first.
  swarm_ = node.advertise<auv_msgs::SwarmState>(topics::kSwarmState, kSentQueue, true);
  clock_ = node.advertise<rosgraph_msgs::Clock>(topics::kClock, kSentQueue, true);
  swarm_message_.header.frame_id = frames::kWorld;
  swarm_message_.poses.resize(auvs_.size());
  swarm_message_.twists.resize(auvs_.size());
  swarm_message_.target_positions.resize(static_cast<std::size_t>(scenario_.target.count));
  swarm_message_.target_velocities.resize(swarm_message_.target_positions.size());
  for (int k = 0; k < scenario_.target.count; ++k) {
    targets_.push_back(node.advertise<nav_msgs::Odometry>(topics::TargetOdom(k), kSentQueue, true));
    nav_msgs::Odometry m;
    m.header.frame_id = frames::kWorld;
    m.child_frame_id = frames::Target(k);
    m.pose.pose.orientation.w = 1.0;
    target_messages_.push_back(m);
  }
  detection_message_.header.frame_id = frames::kWorld;
  SendWorldNed();
  std_msgs::String resolved;
  resolved.data = config::ResolvedText(ScenarioSource());
  scenario_topic_ = node.advertise<std_msgs::String>(topics::kScenario, 1, true);
  scenario_topic_.publish(resolved);
}

void WorldPublisher::SendWorldNed() {
  // North is y of ENU, east is x, down is -z: half a turn about the axis between x and y.
  geometry_msgs::TransformStamped ned;
  ned.header.frame_id = frames::kWorld;
  ned.child_frame_id = frames::kWorldNed;
  ned.transform.rotation.x = ned.transform.rotation.y = std::sqrt(0.5);
  static_frames_.sendTransform(ned);
}

void WorldPublisher::PublishClock(TimeNs now) {
  const ros::WallTime wall = ros::WallTime::now();
  if ((wall - clock_sent_).toSec() < 0.1 * display_period_s_) return;
  clock_sent_ = wall;
  rosgraph_msgs::Clock clock;
  clock.clock = TimeOf(now);
  clock_.publish(clock);
}

void WorldPublisher::PublishSensors(const dynamics::World& world, TimeNs start,
                                    std::uint32_t episode, std::uint32_t step) {
  const TimeNs now = start + world.time(0);
  for (int i = 0; i < world.agents(); ++i) {
    AuvTopics& auv = auvs_[static_cast<std::size_t>(i)];
    auv_msgs::SensorSync& sync = auv.sync_message;
    sync.detections = static_cast<std::uint32_t>(PublishDetections(world, now, i));
    SetOdometry(world.Nav(0, i), start, &auv.odometry_message);
    auv.odometry.publish(auv.odometry_message);
    sync.header.stamp = TimeOf(now);
    sync.episode = episode;
    sync.step = step;
    sync.seed = world.seed(0);
    if (step == 0) {
      sync.cue_valid = true;  // and stays in the message, for an agent that comes late
      const dynamics::Cue cue = world.InitialCue(0, i, scenario_.target_of(i));
      SetVector(cue.p_WT, &sync.cue_position);
      sync.cue_std = cue.std_m;
    }
    auv.sync.publish(sync);
    swarm_message_.poses[static_cast<std::size_t>(i)] = auv.odometry_message.pose.pose;
    swarm_message_.twists[static_cast<std::size_t>(i)] = auv.odometry_message.twist.twist;
  }
  for (int k = 0; k < world.targets(); ++k) {
    const auto u = static_cast<std::size_t>(k);
    SetVector(Lane(world.target(k).p_WT, 0), &swarm_message_.target_positions[u]);
    SetVector(Lane(world.target(k).v_WT, 0), &swarm_message_.target_velocities[u]);
  }
  swarm_message_.header.stamp = TimeOf(now);
  swarm_message_.episode = episode;
  swarm_message_.step = step;
  swarm_message_.seed = world.seed(0);
}

void WorldPublisher::PublishSwarm() { swarm_.publish(swarm_message_); }

void WorldPublisher::PublishViews(const dynamics::World& world, TimeNs start) {
  const TimeNs now = start + world.time(0);
  for (int k = 0; k < world.targets(); ++k) {
    nav_msgs::Odometry& m = target_messages_[static_cast<std::size_t>(k)];
    m.header.stamp = TimeOf(now);
    SetVector(Lane(world.target(k).p_WT, 0), &m.pose.pose.position);
    SetVector(Lane(world.target(k).v_WT, 0), &m.twist.twist.linear);
    targets_[static_cast<std::size_t>(k)].publish(m);
  }
  PublishFrames(now);
  PublishClock(now);
}

int WorldPublisher::PublishDetections(const dynamics::World& world, TimeNs now, int i) {
  int count = 0;
  for (int k = 0; k < world.targets(); ++k) {
    dynamics::Detection detection;
    if (!world.Sense(0, i, k, &detection)) continue;
    auv_msgs::TargetDetection& m = detection_message_;
    const Vec3<double> r = detection.p_WT - Lane(world.vehicle(i).p_WB, 0);
    const double variance = detection.std_m * detection.std_m;
    m.header.stamp = TimeOf(now);
    m.target = static_cast<std::uint32_t>(k);
    SetVector(r, &m.relative_position);
    SetVector(detection.p_WT, &m.position);
    SetVector({variance, variance, variance}, &m.variance);
    m.range = Norm(r);
    auvs_[static_cast<std::size_t>(i)].detection.publish(m);
    ++count;
  }
  return count;
}

void WorldPublisher::PublishFrames(TimeNs now) {
  const ros::WallTime wall = ros::WallTime::now();
  if ((wall - frames_sent_).toSec() < display_period_s_) return;
  frames_sent_ = wall;
  transforms_.clear();
  for (const AuvTopics& auv : auvs_) transforms_.push_back(TransformOf(auv.odometry_message));
  for (const auto& target : target_messages_) transforms_.push_back(TransformOf(target));
  for (auto& t : transforms_) t.header.stamp = TimeOf(now);
  frames_.sendTransform(transforms_);
}

}  // namespace stg::nodes

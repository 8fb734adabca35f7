#include "world_publisher.hpp"

#include <rosgraph_msgs/Clock.h>
#include <std_msgs/String.h>

#include <cmath>

#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kSentQueue = 100;

geometry_msgs::TransformStamped TransformOf(const std::string& child,
                                            const geometry_msgs::Pose& pose) {
  geometry_msgs::TransformStamped t;
  t.header.frame_id = frames::kWorld;
  t.child_frame_id = child;
  t.transform.translation.x = pose.position.x;
  t.transform.translation.y = pose.position.y;
  t.transform.translation.z = pose.position.z;
  t.transform.rotation = pose.orientation;
  return t;
}

}  // namespace

WorldPublisher::WorldPublisher(int agents, const dynamics::TargetConfig& target,
                               double display_rate_hz)
    : target_(target),
      display_period_s_(1.0 / display_rate_hz),
      run_(ros::WallTime::now().toNSec()),
      auvs_(static_cast<std::size_t>(agents)),
      targets_(static_cast<std::size_t>(target.count)),
      target_messages_(targets_.size()) {
  Advertise();
  swarm_message_.header.frame_id = frames::kWorld;
  swarm_message_.poses.resize(auvs_.size());
  swarm_message_.twists.resize(auvs_.size());
  swarm_message_.velocities.resize(auvs_.size());
  swarm_message_.wrenches.resize(auvs_.size());
  swarm_message_.fresh.resize(auvs_.size());
  swarm_message_.target_positions.resize(targets_.size());
  swarm_message_.target_velocities.resize(targets_.size());
  SendWorldNed();
  std_msgs::String resolved;
  resolved.data = config::ResolvedText(ScenarioSource());
  scenario_topic_ = ros::NodeHandle().advertise<std_msgs::String>(topics::kScenario, 1, true);
  scenario_topic_.publish(resolved);
}

void WorldPublisher::Advertise() {
  ros::NodeHandle node;
  for (int i = 0; i < static_cast<int>(auvs_.size()); ++i) {
    AuvTopics& auv = auvs_[static_cast<std::size_t>(i)];
    auv.frame_message.header.frame_id = frames::Body(i);
    auv.frame = node.advertise<auv_msgs::SensorFrame>(topics::AuvTopic(i, topics::kSensorFrame),
                                                      kSentQueue, true);
    auv.odometry.Advertise(topics::AuvTopic(i, topics::kOdom), kSentQueue,
                           [&auv, i](nav_msgs::Odometry* m) {
                             m->header.stamp = auv.frame_message.header.stamp;
                             m->header.frame_id = frames::kWorld;
                             m->child_frame_id = frames::Body(i);
                             m->pose.pose = auv.frame_message.pose;
                             m->twist.twist = auv.frame_message.twist;
                             SetCovariance(auv.navigation, &m->pose);
                             return !m->header.stamp.isZero();
                           });
    auv.detection.Advertise(topics::AuvTopic(i, topics::kTargetDetection), kSentQueue,
                            [&auv](auv_msgs::TargetDetection* m) {
                              *m = auv.last_detection;
                              return !m->header.stamp.isZero();
                            });
  }
  // roscpp sends in the order of these lines, so the agents get their messages first.
  swarm_ = node.advertise<auv_msgs::SwarmState>(topics::kSwarmState, kSentQueue, true);
  clock_ = node.advertise<rosgraph_msgs::Clock>(topics::kClock, kSentQueue, true);
  detections_.Advertise(topics::kSwarmDetections, kSentQueue,
                        [this](auto* message) { return SetNewDetections(message); });
  for (int k = 0; k < target_.count; ++k) {
    nav_msgs::Odometry& message = target_messages_[static_cast<std::size_t>(k)];
    message.header.frame_id = frames::kWorld;
    message.child_frame_id = frames::Target(k);
    message.pose.pose.orientation.w = 1.0;
    targets_[static_cast<std::size_t>(k)].Advertise(topics::TargetOdom(k), kSentQueue,
                                                    [&message](nav_msgs::Odometry* m) {
                                                      *m = message;
                                                      return !m->header.stamp.isZero();
                                                    });
  }
}

void WorldPublisher::SendWorldNed() {
  // North is y of ENU, east is x, and down is -z: half a turn about the axis between x and y.
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

void WorldPublisher::SetWrenches(const std::vector<dynamics::Wrench<double>>& wrenches,
                                 const std::vector<std::uint8_t>& fresh, bool channel_fresh) {
  for (std::size_t i = 0; i < auvs_.size(); ++i) {
    SetVector(wrenches[i].force, &swarm_message_.wrenches[i].force);
    SetVector(wrenches[i].moment, &swarm_message_.wrenches[i].torque);
  }
  swarm_message_.fresh = fresh;
  swarm_message_.channel_fresh = channel_fresh;
}

void WorldPublisher::SetEfforts(const std::vector<double>& efforts,
                                const std::vector<std::uint8_t>& fresh, bool channel_fresh) {
  swarm_message_.efforts = efforts;
  swarm_message_.fresh = fresh;
  swarm_message_.channel_fresh = channel_fresh;
}

void WorldPublisher::PublishNavigation(const dynamics::World& world, TimeNs start) {
  for (int i = 0; i < world.agents(); ++i) {
    AuvTopics& auv = auvs_[static_cast<std::size_t>(i)];
    SetNavigationOf(world, start, i, &auv);
    auv.odometry.Publish();
  }
}

void WorldPublisher::PublishSensors(const dynamics::World& world, TimeNs start,
                                    std::uint32_t episode, std::uint32_t step) {
  const TimeNs now = start + world.time(0);
  for (int i = 0; i < world.agents(); ++i) {
    AuvTopics& auv = auvs_[static_cast<std::size_t>(i)];
    auv_msgs::SensorFrame& frame = auv.frame_message;
    frame.run = run_;
    frame.episode = episode;
    frame.step = step;
    SetFrame(world, start, i, &auv);
    auv.frame.publish(frame);
    const auto u = static_cast<std::size_t>(i);
    SetNavigation(world.Truth(0, i), &swarm_message_.poses[u], &swarm_message_.twists[u]);
    SetVector(Lane(world.vehicle(i).v_WB, 0), &swarm_message_.velocities[u]);
  }
  for (AuvTopics& auv : auvs_) {
    auv.odometry.Publish();
    for (const auv_msgs::TargetDetection& detection : auv.frame_message.detections) {
      auv.last_detection = detection;
      auv.detection.Publish();
    }
  }
  for (int k = 0; k < world.targets(); ++k) {
    const auto u = static_cast<std::size_t>(k);
    SetVector(Lane(world.target(k).p_WT, 0), &swarm_message_.target_positions[u]);
    SetVector(Lane(world.target(k).v_WT, 0), &swarm_message_.target_velocities[u]);
  }
  swarm_message_.groundings.clear();
  swarm_message_.collisions.clear();
  for (int i = 0; world.open_water() && i < world.agents(); ++i) {
    const auto whole = [](const Pack& x) { return static_cast<std::uint32_t>(Lane(x, 0)); };
    swarm_message_.groundings.push_back(whole(world.sea().groundings(i)));
    swarm_message_.collisions.push_back(whole(world.sea().collisions(i)));
  }
  swarm_message_.header.stamp = TimeOf(now);
  swarm_message_.run = run_;
  swarm_message_.episode = episode;
  swarm_message_.step = step;
  swarm_message_.seed = world.seed(0);
}

void WorldPublisher::SetNavigationOf(const dynamics::World& world, TimeNs start, int i,
                                     AuvTopics* auv) {
  auv_msgs::SensorFrame& m = auv->frame_message;
  auv->navigation = world.Nav(0, i);
  const dynamics::NavState& nav = auv->navigation;
  m.header.stamp = TimeOf(start + nav.stamp);
  SetNavigation(nav, &m.pose, &m.twist);
  m.position_std = nav.position_std_m;
  m.heading_std = nav.heading_std_rad;
  m.fix_std = nav.fix_std_m;
  m.fix_stamp = nav.fix_std_m > 0.0 ? TimeOf(start + nav.fix_stamp) : ros::Time();
  SetVector(nav.p_WF, &m.fix_position);
}

void WorldPublisher::SetFrame(const dynamics::World& world, TimeNs start, int i,
                              AuvTopics* auv) const {
  auv_msgs::SensorFrame& m = auv->frame_message;
  SetNavigationOf(world, start, i, auv);
  m.seed = world.seed(0);
  SetDetections(world, start + world.time(0), i, &m);
  if (m.step == 0) {
    m.cue_valid = true;  // it stays in the message for an agent that joins late
    const dynamics::Cue cue = world.InitialCue(0, i, target_.of(i));
    SetVector(cue.p_WT, &m.cue_position);
    m.cue_std = cue.std_m;
    m.cues.clear();
    for (int k = 0; k < world.targets(); ++k) {
      m.cues.emplace_back();
      SetVector(world.InitialCue(0, i, k).p_WT, &m.cues.back());
    }
  }
}

void WorldPublisher::SetDetections(const dynamics::World& world, TimeNs now, int i,
                                   auv_msgs::SensorFrame* frame) const {
  frame->detections.clear();
  world.SenseTargets(0, i, [now, frame](const dynamics::Detection& detection) {
    frame->detections.emplace_back();
    auv_msgs::TargetDetection& m = frame->detections.back();
    m.header.stamp = TimeOf(now);
    m.header.frame_id = frames::kWorld;
    SetDetection(detection, &m);
  });
}

void WorldPublisher::PublishSwarm() { swarm_.publish(swarm_message_); }

void WorldPublisher::PublishViews(const dynamics::World& world, TimeNs start) {
  const TimeNs now = start + world.time(0);
  for (int k = 0; k < world.targets(); ++k) {
    nav_msgs::Odometry& m = target_messages_[static_cast<std::size_t>(k)];
    m.header.stamp = TimeOf(now);
    SetVector(Lane(world.target(k).p_WT, 0), &m.pose.pose.position);
    SetVector(Lane(world.target(k).v_WT, 0), &m.twist.twist.linear);
    targets_[static_cast<std::size_t>(k)].Publish();
  }
  PublishDetections(now);
  PublishFrames(now);
  PublishClock(now);
}

void WorldPublisher::PublishDetections(TimeNs now) {
  const ros::WallTime wall = ros::WallTime::now();
  if ((wall - detections_sent_).toSec() < display_period_s_) return;
  detections_sent_ = wall;
  detections_.Publish();
  detections_until_ = TimeOf(now);
}

bool WorldPublisher::SetNewDetections(auv_msgs::SwarmDetections* message) const {
  message->header = swarm_message_.header;
  message->agents.clear();
  message->detections.clear();
  for (std::size_t i = 0; i < auvs_.size(); ++i) {
    if (auvs_[i].last_detection.header.stamp <= detections_until_) continue;
    message->agents.push_back(static_cast<std::uint32_t>(i));
    message->detections.push_back(auvs_[i].last_detection);
  }
  return !message->agents.empty();
}

void WorldPublisher::PublishFrames(TimeNs now) {
  const ros::WallTime wall = ros::WallTime::now();
  if ((wall - frames_sent_).toSec() < display_period_s_) return;
  frames_sent_ = wall;
  transforms_.clear();
  for (std::size_t i = 0; i < auvs_.size(); ++i) {
    transforms_.push_back(
        TransformOf(auvs_[i].frame_message.header.frame_id, swarm_message_.poses[i]));
  }
  for (const auto& target : target_messages_) {
    transforms_.push_back(TransformOf(target.child_frame_id, target.pose.pose));
  }
  for (auto& t : transforms_) t.header.stamp = TimeOf(now);
  frames_.sendTransform(transforms_);
}

}  // namespace stg::nodes

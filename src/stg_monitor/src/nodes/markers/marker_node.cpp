/// Shows a running or replayed swarm in rviz. It only listens, so it may start, stop or be late
/// without any effect on the run.
/// Long because: the subscription and the callback of each topic are here.

#include <auv_msgs/LinkState.h>
#include <auv_msgs/LinkStates.h>
#include <auv_msgs/PacketEvents.h>
#include <auv_msgs/SwarmState.h>
#include <auv_msgs/TargetDetection.h>
#include <auv_msgs/TaskState.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <visualization_msgs/MarkerArray.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <system_error>

#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/conversions.hpp"
#include "auv_common/nodes/health.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "auv_dynamics/terrain/seascape.hpp"
#include "marker_builder.hpp"
#include "message_views.hpp"
#include "parts/terrain_markers.hpp"
#include "scene.hpp"
#include "shapes/swarm_view.hpp"
#include "stg_agent/nodes/topics.hpp"
#include "topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::size_t kMaxVehicles = 256, kMaxTargets = 64, kMaxStations = 32,
                      kMaxTrailPoints = 1500;
constexpr int kOdomQueue = 20;  // number of steps by which an AUV may be late
// A carrier is shown for this time after its end, because its sound is still on its way.
constexpr double kLongestShown_s = 5.0;

class MarkerNode {
 public:
  MarkerNode()
      : private_nh_("~"), health_("markers", "view", [this](auto& status) { Report(status); }) {
    overview_.vehicle_scale = NumberParameter("overview/vehicle_scale", 8.0, 1e-3, 1e6);
    close_.vehicle_scale = NumberParameter("close/vehicle_scale", 1.0, 1e-3, 1e6);
    overview_.trail_s = NumberParameter("overview/trail_s", 60.0, 0.0, 1e6);
    close_.trail_s = NumberParameter("close/trail_s", 8.0, 0.0, 1e6);
    overview_.whole_workspace = true;
    for (MarkerStyle* style : {&overview_, &close_}) {
      style->lost_packet_s = NumberParameter("lost_packet_s", style->lost_packet_s, 0.0, 1e6);
      style->prediction_s = NumberParameter("prediction_s", style->prediction_s, 0.0, 1e6);
    }
    const double rate_hz = NumberParameter("rate_hz", 20.0, 0.01, 1000.0);

    overview_pub_ = private_nh_.advertise<visualization_msgs::MarkerArray>(topics::kOverview, 1);
    terrain_pub_ =
        private_nh_.advertise<visualization_msgs::MarkerArray>(topics::kTerrain, 2, true);
    close_pub_ = private_nh_.advertise<visualization_msgs::MarkerArray>(topics::kClose, 1);
    scenario_sub_ = nh_.subscribe(topics::kScenario, 1, &MarkerNode::OnScenario, this);
    truth_sub_ = nh_.subscribe(topics::kSwarmState, 20, &MarkerNode::OnTruth, this);
    packets_sub_ = nh_.subscribe(topics::kPackets, 50, &MarkerNode::OnPackets, this);
    links_sub_ = nh_.subscribe(topics::kLinks, 50, &MarkerNode::OnLinks, this);
    const std::string file = TextParameter("scenario_file", "");
    if (!file.empty()) ReadScenarioFile(file);
    // Wall clock, so that a paused or finished replay stays visible.
    draw_timer_ = nh_.createWallTimer(ros::WallDuration(1.0 / rate_hz), &MarkerNode::OnDraw, this);
    discover_timer_ = nh_.createWallTimer(ros::WallDuration(0.5), &MarkerNode::OnDiscover, this);
  }

  void Spin() { ros::spin(); }

 private:
  void ReadScenarioFile(const std::string& file) {
    std::error_code error;
    std::ifstream in(file);
    if (!std::filesystem::is_regular_file(file, error) || !in) {
      throw UserError("scenario_file: cannot read '" + file + "'");
    }
    std_msgs::String text;
    text.data.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    OnScenario(text);
  }

  /// Shows the terrain of open water. If its file is missing (a bag of another machine), the rest
  /// is still shown.
  void ShowTerrain() {
    const SceneConfig& scene = view_.scene;
    terrain_pub_.publish(NoTerrain());
    if (!scene.sea.open) return;
    try {
      terrain_pub_.publish(BuildTerrain(scene, dynamics::Seascape(scene.sea, scene.half_extent_m)));
    } catch (const UserError& e) {
      ROS_WARN("the bottom of the sea is not shown: %s", e.what());
    }
  }

  void OnScenario(const std_msgs::String& text) {
    try {
      view_.scene = ReadScene(text.data);
      ShowTerrain();
    } catch (const YAML::Exception& e) {
      ROS_ERROR("/scenario is not a scenario, walls and bands are the default ones: %s", e.what());
    }
  }

  /// Subscribes to every AUV and target with a publisher: any number, live or from a bag.
  void OnDiscover(const ros::WallTimerEvent&) {
    static const std::regex kPattern("/(auv|target|station)_([0-9]{1,4})/odom");
    ros::master::V_TopicInfo topics;
    if (!ros::master::getTopics(topics)) return;
    for (const ros::master::TopicInfo& topic : topics) {
      std::smatch match;
      if (!std::regex_match(topic.name, match, kPattern)) continue;
      const std::size_t index = std::stoul(match[2]);
      if (match[1] == "auv") {
        if (index < kMaxVehicles) AddVehicles(index + 1);
      } else if (match[1] == "station") {
        if (index < kMaxStations) AddStations(index + 1);
      } else if (index < kMaxTargets) {
        AddTargets(index + 1);
      }
    }
  }

  void AddVehicles(std::size_t count) {
    for (std::size_t i = view_.vehicles.size(); i < count; ++i) {
      view_.vehicles.emplace_back();
      const int id = static_cast<int>(i);
      subscribers_.push_back(nh_.subscribe<nav_msgs::Odometry>(
          topics::AuvTopic(id, topics::kOdom), kOdomQueue,
          [this, i](const nav_msgs::Odometry::ConstPtr& m) { OnOdom(i, *m); }));
      subscribers_.push_back(nh_.subscribe<auv_msgs::TaskState>(
          topics::AuvTopic(id, topics::kTaskState), 20,
          [this, i](const auv_msgs::TaskState::ConstPtr& m) { OnTask(i, *m); }));
      subscribers_.push_back(nh_.subscribe<auv_msgs::TargetDetection>(
          topics::AuvTopic(id, topics::kTargetDetection), 20,
          [this, i](const auv_msgs::TargetDetection::ConstPtr& m) { OnDetection(i, *m); }));
    }
  }

  void AddStations(std::size_t count) {
    for (std::size_t k = view_.stations.size(); k < count; ++k) {
      view_.stations.emplace_back();
      subscribers_.push_back(
          nh_.subscribe<nav_msgs::Odometry>(topics::StationOdom(static_cast<int>(k)), kOdomQueue,
                                            [this, k](const nav_msgs::Odometry::ConstPtr& m) {
                                              if (Finite(m->pose.pose.position))
                                                view_.stations[k] = m->pose.pose.position;
                                            }));
    }
  }

  void AddTargets(std::size_t count) {
    for (std::size_t k = view_.targets.size(); k < count; ++k) {
      view_.targets.emplace_back();
      subscribers_.push_back(nh_.subscribe<nav_msgs::Odometry>(
          topics::TargetOdom(static_cast<int>(k)), kOdomQueue,
          [this, k](const nav_msgs::Odometry::ConstPtr& m) { OnTarget(k, *m); }));
    }
  }

  /// Advances the simulated time. If it jumps back by more than an AUV may be late (a replay starts
  /// again), the past is forgotten.
  void Advance(const ros::Time& stamp) {
    const double t = stamp.toSec();
    if (t < view_.now - std::max(1.0, kOdomQueue * view_.step_s)) ForgetPast();
    if (t > view_.now && view_.now > 0.0) view_.step_s = t - view_.now;
    view_.now = std::max(view_.now, t);
  }

  void ForgetPast() {
    for (VehicleView& v : view_.vehicles) v.trail.clear();
    for (MovingTarget& t : view_.targets) t.trail.clear();
    view_.packets.clear();
    view_.carriers.clear();
    view_.links.clear();
    view_.now = 0.0;
  }

  double TrailSeconds() const {
    return std::max(TrailSecondsOf(view_, overview_), TrailSecondsOf(view_, close_));
  }

  void Extend(std::deque<TrailPoint>* trail, const geometry_msgs::Point& p, ShownPhase phase) {
    if (!trail->empty()) {
      const geometry_msgs::Point& q = trail->back().position;
      const double step = std::max(0.1 * view_.scene.radius_m, 1e-3 * view_.scene.band_hi_m);
      if (std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) < step) return;
    }
    trail->push_back({view_.now, p, phase});
    while (!trail->empty() &&
           (trail->size() > kMaxTrailPoints || trail->front().time < view_.now - TrailSeconds())) {
      trail->pop_front();
    }
  }

  void OnOdom(std::size_t i, const nav_msgs::Odometry& odom) {
    if (!Finite(odom.pose.pose.position)) return refused_.Add(Refusals::kNotFinite);
    if (!PossibleStamp(odom.header.stamp)) return refused_.Add(Refusals::kStale);
    SetNodeTime(odom.header.stamp);
    Advance(odom.header.stamp);
    if (!has_truth_) Place(i, odom.pose.pose);
  }

  /// Shows the true positions of the AUVs. The odometry has their estimated positions.
  void OnTruth(const auv_msgs::SwarmState& swarm) {
    has_truth_ = true;
    const std::size_t count = std::min(swarm.poses.size(), view_.vehicles.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (Finite(swarm.poses[i].position)) Place(i, swarm.poses[i]);
    }
  }

  void Place(std::size_t i, const geometry_msgs::Pose& pose) {
    VehicleView& v = view_.vehicles[i];
    v.seen = true;
    v.pose = pose;
    Extend(&v.trail, pose.position, v.phase);
  }

  void OnDetection(std::size_t i, const auv_msgs::TargetDetection& m) {
    const DetectionView d = DetectionOf(m);
    if (!std::isfinite(d.range_m + d.azimuth_rad + d.elevation_rad)) {
      return refused_.Add(Refusals::kNotFinite);
    }
    view_.vehicles[i].detection = d;
  }

  void OnTarget(std::size_t k, const nav_msgs::Odometry& odom) {
    if (!Finite(odom.pose.pose.position)) return refused_.Add(Refusals::kNotFinite);
    MovingTarget& t = view_.targets[k];
    t.seen = true;
    t.position = odom.pose.pose.position;
    t.velocity = VelocityOf(odom);
    Extend(&t.trail, t.position, ShownPhase::kUnknown);
  }

  void OnTask(std::size_t i, const auv_msgs::TaskState& task) {
    if (!PossibleStamp(task.header.stamp)) return refused_.Add(Refusals::kStale);
    // Only the messages of AUV 0 change the episode, because messages of the others may still be
    // from the previous one.
    if (i == 0 && task.episode != view_.episode) {
      view_.episode = task.episode;
      ForgetPast();
      view_.now = task.header.stamp.toSec();
    }
    view_.step = task.step;
    VehicleView& v = view_.vehicles[i];
    v.phase = task.phase <= auv_msgs::TaskState::LOST ? static_cast<ShownPhase>(task.phase)
                                                      : ShownPhase::kUnknown;
    v.leader = task.role;
    v.target_known = task.target_known && Finite(task.target_position);
    v.distance = v.target_known ? task.target_distance : -1.0;
    v.estimate = task.target_position;
    v.estimate_std = std::isfinite(task.target_std) ? task.target_std : 0.0;
    std::copy(task.target_covariance.begin(), task.target_covariance.end(), v.covariance.begin());
  }

  void OnLinks(const auv_msgs::LinkStates& states) {
    const double t = states.header.stamp.toSec();
    for (const auv_msgs::LinkState& s : states.links) {
      if (s.source >= kMaxVehicles || s.destination >= kMaxVehicles) continue;
      const int source = static_cast<int>(s.source), destination = static_cast<int>(s.destination);
      const auto [found, is_new] = view_.links.try_emplace({source, destination});
      LinkView& link = found->second;
      // Counts are only used for packets if there are no messages about packets.
      const bool counts = !is_new && !has_packets_;
      if (counts && s.delivered > link.delivered) {
        view_.packets.push_back({source, destination, t, false, auv_msgs::LinkState::NONE});
      }
      if (counts && s.dropped > link.dropped) {
        view_.packets.push_back({source, destination, t, true, s.last_drop_reason});
      }
      link = {std::isfinite(s.quality) ? s.quality : 0.0, s.age, s.delivered, s.dropped};
    }
  }

  void OnPackets(const auv_msgs::PacketEvents& events) {
    has_packets_ = true;
    const double t = events.header.stamp.toSec();
    for (const auv_msgs::PacketEvent& e : events.events) {
      if (e.source >= kMaxVehicles) continue;
      const int source = static_cast<int>(e.source);
      if (e.kind == auv_msgs::PacketEvent::SENT) {
        const double begin = e.transmit.toSec();
        view_.carriers.push_back({source, begin, begin + std::max(e.airtime, 0.0)});
      } else if (e.receiver >= 0 && e.receiver < static_cast<int>(kMaxVehicles) &&
                 (e.kind == auv_msgs::PacketEvent::DELIVERED ||
                  e.kind == auv_msgs::PacketEvent::DROPPED)) {
        // A lost or received packet is shown when its sound arrives.
        const double arrives = std::max(t, e.arrival.toSec());
        const bool lost = e.kind == auv_msgs::PacketEvent::DROPPED;
        view_.packets.push_back({source, e.receiver, arrives, lost, e.reason});
      }
    }
  }

  /// Removes data that is too old to be shown.
  void Forget() {
    const double shown_s = std::max(kLongestShown_s, view_.step_s);
    const auto old = [&](const CarrierView& c) { return c.end < view_.now - shown_s; };
    view_.carriers.erase(std::remove_if(view_.carriers.begin(), view_.carriers.end(), old),
                         view_.carriers.end());
    const double lost_s = std::max(overview_.lost_packet_s, view_.step_s);
    const auto past = [&](const PacketEvent& e) { return e.time < view_.now - lost_s; };
    view_.packets.erase(std::remove_if(view_.packets.begin(), view_.packets.end(), past),
                        view_.packets.end());
  }

  void OnDraw(const ros::WallTimerEvent&) {
    Forget();
    Draw(overview_, &overview_pub_);
    Draw(close_, &close_pub_);
    health_.Tick();
  }

  void Draw(const MarkerStyle& style, ros::Publisher* publisher) {
    if (publisher->getNumSubscribers() == 0) return;
    publisher->publish(BuildMarkers(view_, style));
    drawn_.Add();
  }

  void Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
    const auto seen = [](const auto& all) {
      return std::count_if(all.begin(), all.end(), [](const auto& one) { return one.seen; });
    };
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
    status.add("AUVs seen", seen(view_.vehicles));
    status.add("targets seen", seen(view_.targets));
    status.add("views drawn per second",
               static_cast<double>(drawn_.TakeRecent()) / health_.period_s());
    refused_.Report(topics::kOdom, &status);
    if (seen(view_.vehicles) == 0) {
      status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN,
                          "no position of any AUV has arrived");
    }
  }

  ros::NodeHandle nh_, private_nh_;
  MarkerStyle overview_, close_;
  SwarmView view_;
  ros::Publisher overview_pub_, close_pub_, terrain_pub_;
  ros::Subscriber scenario_sub_, links_sub_, packets_sub_, truth_sub_;
  bool has_truth_ = false;
  bool has_packets_ = false;
  std::vector<ros::Subscriber> subscribers_;
  ros::WallTimer draw_timer_, discover_timer_;
  Health health_;
  EventRate drawn_;
  Refusals refused_;
};

}  // namespace
}  // namespace stg::nodes

int main(int argc, char** argv) {
  stg::nodes::WatchOnly();
  return stg::nodes::RunNode<stg::nodes::MarkerNode>(argc, argv, "markers",
                                                     stg::nodes::NodeClock::kMessages);
}

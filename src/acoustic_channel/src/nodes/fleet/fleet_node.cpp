#include "fleet_node.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "acoustic_channel/fleet/fleet_config.hpp"
#include "acoustic_channel/nodes/conversions.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/sound_bag.hpp"
#include "auv_common/regular_file.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 1000;
/// Messages that were sent at the same time arrive within this wall time.
constexpr double kSettling_s = 0.02;
/// If the clock goes back by more, a new run begins. A smaller step is a correction.
constexpr TimeNs kStepBack = 1'000'000'000;
/// If the clock goes forward by more, it is another clock.
constexpr TimeNs kStepForward = 3'600'000'000'000;

TimeNs Nanoseconds(double s) { return static_cast<TimeNs>(std::llround(s * 1e9)); }

acoustics::NetworkConfig NetworkParameters(const std::vector<FleetVehicle>& vehicles) {
  const std::string name = TextParameter("config", "");
  if (name.empty()) throw UserError("parameter config: must name a file with the section channel");
  const bool path = name.find('/') != std::string::npos || name.find(".yaml") != std::string::npos;
  const std::string file = path ? name : config::NamedSource(config::ScenarioFolder(), name).file;
  std::vector<std::string> overrides = TextsParameter("overrides");
  const double step_s = NumberParameter("step", 0.0, 0.0, 10.0);
  if (step_s > 0.0) {
    overrides.push_back("time.dt_s=" + std::to_string(step_s));
    overrides.push_back("time.decision_steps=1");
  }
  const int seed = IntegerParameter("seed", -1, -1, 2'147'483'647);
  if (seed >= 0) overrides.push_back("seed=" + std::to_string(seed));
  return acoustics::LoadFleetNetwork(file, overrides, static_cast<int>(vehicles.size()));
}

acoustics::FleetPatience PatienceParameters() {
  acoustics::FleetPatience p;
  p.lag_s = NumberParameter("lag", p.lag_s, 0.0, 60.0);
  p.odometry_s = NumberParameter("patience", p.odometry_s, 0.0, 3600.0);
  p.silent_after_s = NumberParameter("silent_after", p.silent_after_s, 0.001, 3600.0);
  p.has_velocity = TextParameter("twist", "body") != "none";
  return p;
}

std::vector<int> IdsOf(const std::vector<FleetVehicle>& vehicles) {
  std::vector<int> ids;
  for (const FleetVehicle& v : vehicles) ids.push_back(v.id);
  return ids;
}

/// Opens the bag before anything is written. Returns null if `path` is empty.
std::unique_ptr<rosbag::Bag> OpenBag(const std::string& path) {
  if (path.empty()) return nullptr;
  auto bag = std::make_unique<rosbag::Bag>();
  try {
    RequireRegularFile(path);
    RequireSoundBag(path);
    bag->open(path, rosbag::bagmode::Read);
  } catch (const UserError& error) {
    throw UserError(std::string("parameter bag: ") + error.what());
  } catch (const std::exception& error) {  // a damaged bag causes many kinds of errors
    throw UserError("parameter bag: " + path + ": " + error.what());
  }
  return bag;
}

}  // namespace

FleetNode::TwistFrame FleetNode::TwistParameter() {
  const std::string name = TextParameter("twist", "body");
  if (name == "body") return TwistFrame::kBody;
  if (name == "world") return TwistFrame::kWorld;
  if (name == "none") return TwistFrame::kNone;
  throw UserError("parameter twist: must be body, world or none");
}

FleetNode::FleetNode()
    : vehicles_(VehicleListParameter()),
      network_(NetworkParameters(vehicles_)),
      fleet_(network_, PatienceParameters(), this),
      twist_(TwistParameter()),
      frame_(TextParameter("frame", "")),
      tolerance_(Nanoseconds(NumberParameter("stamp_tolerance", 5.0, 0.0, 1e6))),
      display_period_s_(1.0 / NumberParameter("display_rate", 20.0, 0.01, 1e6)),
      bag_(TextParameter("bag", "")),
      clock_deadline_s_(WallSeconds() + NumberParameter("clock_timeout", 30.0, 0.0, 1e6)),
      members_(vehicles_.size()),
      reports_(IdsOf(vehicles_)),
      recording_(OpenBag(bag_)),
      files_(TextParameter("packet_log", ""), IdsOf(vehicles_), bag_),
      health_("acoustic channel", "simulation", [this](auto& status) { Report(status); }) {
  Connect();
}

void FleetNode::Connect() {
  ros::NodeHandle node;
  events_ = node.advertise<auv_msgs::PacketEvents>(topics::kPackets, kQueue);
  links_ = node.advertise<auv_msgs::LinkStates>(topics::kLinks, kQueue, true);
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    const FleetVehicle& v = vehicles_[i];
    const int vehicle = static_cast<int>(i);
    Member& m = members_[i];
    m.reception = node.advertise<auv_msgs::AcousticReception>(v.Topic(topics::kAcousticRx), kQueue);
    m.status = node.advertise<auv_msgs::TransmitStatus>(v.Topic(topics::kAcousticStatus), kQueue);
    if (!bag_.empty()) continue;
    const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> on_odometry =
        [this, vehicle](const auto& message) { OnOdometry(vehicle, message); };
    m.odometry = node.subscribe<nav_msgs::Odometry>(v.odom, kQueue, on_odometry,
                                                    ros::VoidConstPtr(), NoDelay());
    const boost::function<void(const auv_msgs::AcousticPacket::ConstPtr&)> on_packet =
        [this, vehicle](const auto& message) { OnPacket(vehicle, message); };
    m.packets = node.subscribe<auv_msgs::AcousticPacket>(v.Topic(topics::kAcousticTx), kQueue,
                                                         on_packet, ros::VoidConstPtr(), NoDelay());
  }
}

void FleetNode::Spin() {
  if (bag_.empty()) {
    PollLoop([this] { return Work(); }, RealtimePriorityParameter());
  } else {
    ReplayBag();
  }
  fleet_.Finish();
  Tell();
  files_.Flush();
  if (!files_.lost().empty()) {
    throw LostOutput("acoustic channel: packets are missing in " + files_.lost() +
                     ", which could not be written");
  }
}

double FleetNode::Work() {
  WatchClock(NsOf(ros::Time::now()));
  if (now_ == 0 && WallSeconds() > clock_deadline_s_) {
    throw UserError(
        "parameter /use_sim_time is true, but no node has published /clock: start the simulator "
        "first; if an earlier run has left the parameter, `rosparam delete /use_sim_time`");
  }
  if (now_ > 0) {
    JudgeAgain();
    AskPings();
    const double wall_s = WallSeconds();
    if (wall_s - settled_s_ >= kSettling_s) {
      Advance(settled_);
      settled_ = now_;
      settled_s_ = wall_s;
    }
  }
  health_.Tick();
  return kSettling_s / 2.0;
}

void FleetNode::WatchClock(TimeNs now) {
  const bool back = now < now_ - kStepBack;
  const bool forward = fleet_.begun() && now > now_ + kStepForward;
  if (now_ > 0 && (back || forward)) {
    ROS_WARN("the clock went from %.3f to %.3f s: the channel restarts", Seconds(now_),
             Seconds(now));
    StartAnew();
    settled_ = now;
  }
  now_ = now;
}

void FleetNode::StartAnew() {
  fleet_.Finish();
  Tell();
  fleet_.Restart();
  frames_.clear();
  pings_.RefuseAll("the clock went back or jumped ahead: the channel has restarted");
}

/// Closes the steps that are settled at clock time `now`, and reports them.
void FleetNode::Advance(TimeNs now) {
  const TimeNs before = fleet_.closed();
  const bool begun = fleet_.begun();
  fleet_.Run(now);
  if (!fleet_.begun() || (begun && fleet_.closed() == before)) return;
  Tell();
}

/// Reads all messages of the vehicles from a bag, as fast as this machine can.
void FleetNode::ReplayBag() {
  std::map<std::string, int> odometry, packets;
  std::vector<std::string> wanted;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    odometry[vehicles_[i].odom] = static_cast<int>(i);
    packets[vehicles_[i].Topic(topics::kAcousticTx)] = static_cast<int>(i);
    wanted.insert(wanted.end(), {vehicles_[i].odom, vehicles_[i].Topic(topics::kAcousticTx)});
  }
  try {
    ReadBag(rosbag::View(*recording_, rosbag::TopicQuery(wanted)), odometry, packets);
  } catch (const std::exception& error) {  // from rosbag, from a message, or out of memory
    throw UserError("parameter bag: " + bag_ + ": " + error.what());
  }
  fleet_.Finish();
  Tell();
  Conclude();
}

void FleetNode::ReadBag(rosbag::View view, const std::map<std::string, int>& odometry,
                        const std::map<std::string, int>& packets) {
  for (const rosbag::MessageInstance& m : view) {
    if (!ros::ok()) return;
    WatchClock(NsOf(m.getTime()));
    Advance(now_);
    if (const auto odom = m.instantiate<nav_msgs::Odometry>()) {
      const auto found = odometry.find(m.getTopic());
      if (found != odometry.end()) OnOdometry(found->second, odom);
    } else if (const auto packet = m.instantiate<auv_msgs::AcousticPacket>()) {
      const auto found = packets.find(m.getTopic());
      if (found != packets.end()) OnPacket(found->second, packet);
    } else {
      ++foreign_messages_;
    }
    health_.Tick();
  }
}

/// Reports the result of the bag.
void FleetNode::Conclude() {
  const auto count = [](std::uint64_t n) { return static_cast<unsigned long>(n); };
  const acoustics::ChannelTotals& totals = fleet_.channel().totals();
  ROS_INFO("%s: %lu of odometry and %lu packets taken; %lu delivered, %lu lost, by receiver",
           bag_.c_str(), count(odometry_), count(packets_), count(totals.delivered),
           count(totals.dropped));
  if (odometry_ == 0) ROS_WARN("%s: no odometry of any of the vehicles", bag_.c_str());
  if (foreign_messages_ > 0) {
    ROS_WARN("%s: %lu messages on topics of the vehicles are of another type", bag_.c_str(),
             count(foreign_messages_));
  }
  const std::uint64_t refused = refused_odometry_.total() + refused_packets_.total();
  if (refused > 0) {
    ROS_WARN("%s: %lu messages refused, the last one: %s", bag_.c_str(), count(refused),
             last_refusal_.c_str());
  }
}

}  // namespace stg::nodes

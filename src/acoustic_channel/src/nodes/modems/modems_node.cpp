#include "modems_node.hpp"

#include <cmath>

#include "acoustic_channel/nodes/conversions.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 1000;
/// Period in which the node looks for messages of ROS. Hosts get their answers at once.
constexpr TimeNs kLook = 5'000'000;

std::vector<int> IdsOf(const acoustics::ModemFile& file) {
  std::vector<int> ids;
  for (const acoustics::ModemVehicle& v : file.vehicles) ids.push_back(v.id);
  return ids;
}

acoustics::ModemFile FileParameter() {
  const std::string name = TextParameter("config", "");
  if (name.empty())
    throw UserError("parameter config: must name a file with vehicles and a channel");
  return acoustics::LoadModemFile(name);
}

}  // namespace

ModemsNode::ModemsNode()
    : file_(FileParameter()),
      server_(file_, TextParameter("command_log", "")),
      silent_after_(std::llround(NumberParameter("silent_after", 3.0, 0.001, 3600.0) * 1e9)),
      members_(file_.vehicles.size()),
      reports_(IdsOf(file_)),
      health_("acoustic modems", "simulation", [this](auto& status) { Report(status); }) {
  const std::string log = TextParameter("packet_log", "");
  if (!log.empty()) {
    log_file_.open(log);
    if (!log_file_) throw UserError("parameter packet_log: " + log + " cannot be written");
    std::vector<std::string> names;
    for (const int id : IdsOf(file_)) names.push_back(std::to_string(id));
    log_ =
        std::make_unique<acoustics::PacketLog>(&log_file_, static_cast<int>(names.size()), names);
  }
  server_.say = [](const std::string& what) { ROS_INFO("%s", what.c_str()); };
  server_.water().Observe(this);
  Connect();
  for (std::size_t i = 0; i < file_.vehicles.size(); ++i) {
    const acoustics::BytePort* port = server_.port(static_cast<int>(i));
    if (port != nullptr) {
      ROS_INFO("%s: modem on %s, address %d", file_.vehicles[i].name.c_str(), port->name().c_str(),
               file_.vehicles[i].modem->address);
    }
  }
  if (file_.listen != "127.0.0.1") {
    ROS_WARN("modems listen on %s: their protocols have no passwords", file_.listen.c_str());
  }
  if (ros::Time::isSimTime()) {
    ROS_WARN("modems run in wall time: the simulated clock must run at the same rate");
  }
}

void ModemsNode::Connect() {
  ros::NodeHandle node;
  events_ = node.advertise<auv_msgs::PacketEvents>(topics::kPackets, kQueue);
  for (std::size_t i = 0; i < file_.vehicles.size(); ++i) {
    const acoustics::ModemVehicle& v = file_.vehicles[i];
    const int vehicle = static_cast<int>(i);
    Member& m = members_[i];
    if (!v.moored) {
      const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> on_odometry =
          [this, vehicle](const auto& message) { OnOdometry(vehicle, message); };
      m.odometry = node.subscribe<nav_msgs::Odometry>(v.odom, kQueue, on_odometry,
                                                      ros::VoidConstPtr(), NoDelay());
    }
    if (!v.ordinary()) continue;
    const std::string below = "/" + v.name + "/";
    m.reception = node.advertise<auv_msgs::AcousticReception>(below + topics::kAcousticRx, kQueue);
    const boost::function<void(const auv_msgs::AcousticPacket::ConstPtr&)> on_packet =
        [this, vehicle](const auto& message) { OnPacket(vehicle, message); };
    m.packets = node.subscribe<auv_msgs::AcousticPacket>(below + topics::kAcousticTx, kQueue,
                                                         on_packet, ros::VoidConstPtr(), NoDelay());
  }
}

void ModemsNode::Spin() {
  while (ros::ok()) {
    server_.Serve(server_.Now() + kLook);
    start_ = NsOf(ros::Time::now()) - server_.Now();
    HandleMessages(0.0);
    Tell();
    health_.Tick();
  }
}

void ModemsNode::OnOdometry(int vehicle, const nav_msgs::Odometry::ConstPtr& message) {
  if (!FinitePose(message->pose.pose) || !FiniteTwist(message->twist.twist)) {
    refused_.Add(Refusals::kNotFinite);
    return;
  }
  server_.SetPresent(vehicle, true);
  const TimeNs t = server_.Now();  // after SetPresent, which takes the water to its own time
  members_[static_cast<std::size_t>(vehicle)].heard = t;
  server_.water().Move(vehicle, t,
                       {VectorOf(message->pose.pose.position),
                        WorldVelocity(message->pose.pose, message->twist.twist)});
}

void ModemsNode::OnPacket(int vehicle, const auv_msgs::AcousticPacket::ConstPtr& message) {
  const TimeNs t = server_.Now();
  acoustics::Transmission packet;
  packet.source = vehicle;
  packet.destination = acoustics::kToNone;
  for (std::size_t i = 0; i < file_.vehicles.size(); ++i) {
    if (file_.vehicles[i].id == message->destination) packet.destination = static_cast<int>(i);
  }
  if (message->destination == acoustics::kToAll) packet.destination = acoustics::kToAll;
  packet.stamp = packet.generation = t;
  packet.tag = message->sequence;
  packet.payload = acoustics::ViewOf(message->data);
  const std::size_t most = server_.water().network().max_payload();
  if (message->data.empty() || message->data.size() > most || packet.destination == vehicle ||
      packet.destination == acoustics::kToNone) {
    refused_.Add(Refusals::kMalformed);
    return;
  }
  server_.water().Offer(packet, t);
}

void ModemsNode::Tell() {
  const TimeNs now = server_.Now();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const bool silent = now - members_[i].heard > silent_after_;
    if (!file_.vehicles[i].moored && silent) server_.SetPresent(static_cast<int>(i), false);
  }
  PublishReceptions();
  auv_msgs::PacketEvents& events = reports_.message();
  if (events.events.empty()) return;
  events.header.stamp = ros::Time::now();
  events.header.frame_id = frames::kWorld;
  events_.publish(events);
  reports_.Clear();
}

void ModemsNode::PublishReceptions() {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (!file_.vehicles[i].ordinary()) continue;
    received_.clear();
    acoustics::Network& network = server_.water().network();
    network.Take(static_cast<int>(i), network.now(), &received_);
    if (received_.empty()) continue;
    auv_msgs::AcousticReception message;
    message.header.stamp = TimeOf(start_ + received_.back().arrival);
    message.header.frame_id = file_.vehicles[i].name + "/base_link";
    for (acoustics::Reception& r : received_) {
      r.source = file_.vehicles[static_cast<std::size_t>(r.source)].id;
      SetReceivedPacket(r, start_, &message.packets.emplace_back());
    }
    members_[i].reception.publish(message);
  }
}

void ModemsNode::OnQueued(const acoustics::PacketInfo& packet) {
  reports_.Begin(start_);
  reports_.OnQueued(packet);
}
void ModemsNode::OnDiscarded(const acoustics::PacketInfo& packet, acoustics::DropReason reason,
                             TimeNs t) {
  reports_.OnDiscarded(packet, reason, t);
  if (log_) log_->OnDiscarded(packet, reason, t);
}
void ModemsNode::OnSent(const acoustics::PacketInfo& packet) { reports_.OnSent(packet); }
void ModemsNode::OnFate(const acoustics::PacketInfo& packet, const acoustics::PacketFate& fate) {
  reports_.OnFate(packet, fate);
  if (log_) log_->OnFate(packet, fate);
}

void ModemsNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
  status.add("bytes of hosts", server_.bytes_read());
  const acoustics::ChannelTotals& totals = server_.water().network().totals();
  status.add("packets delivered", totals.delivered);
  status.add("packets dropped", totals.dropped);
  for (std::size_t i = 0; i < file_.vehicles.size(); ++i) {
    const int node = static_cast<int>(i);
    const acoustics::BytePort* port = server_.port(node);
    const bool here = server_.water().network().present(node);
    std::string text = here ? "here" : "not in the water";
    if (port != nullptr) {
      text += ", " + port->name() + (port->connected() ? ", a host" : ", no host");
      if (port->dropped() > 0) text += ", dropped " + std::to_string(port->dropped());
    }
    if (const acoustics::ModemPort* modem = server_.gateway(static_cast<int>(i))) {
      text += ", " + modem->name() + (modem->driver().ready() ? ", answers" : ", does not answer");
    }
    status.add(file_.vehicles[i].name, text);
  }
  refused_.Report("messages", &status);
}

}  // namespace stg::nodes

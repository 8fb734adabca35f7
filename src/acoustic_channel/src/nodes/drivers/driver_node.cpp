#include "driver_node.hpp"

#include <auv_msgs/AcousticReception.h>

#include <vector>

#include "acoustic_channel/link/link_statistics.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/conversions.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "modem_parameters.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 100;
/// Period in which the node looks for messages of ROS. Bytes of the modem wake it at once.
constexpr TimeNs kLook = 5'000'000;
using auv_msgs::TransmitStatus;
using Event = acoustics::ModemPort::Event;

int WholeParameter(const std::string& name, double otherwise, double lo, double hi) {
  return static_cast<int>(NumberParameter(name, otherwise, lo, hi));
}

acoustics::ModemPort OpenModem(int id) {
  const std::string port = TextParameter("port", "");
  if (port.empty()) throw UserError("parameter port: must be tcp://HOST:PORT or a serial device");
  acoustics::DriverOptions options;
  const int address = WholeParameter("address", 0, 0, 254);
  options.address = address > 0 ? address : id + 1;
  options.rssi_offset_db = NumberParameter("rssi_offset_db", -190.0, -1e3, 1e3);
  const std::string protocol = TextParameter("protocol", "s2c");
  RefuseUnreadOfModems(protocol, {port});
  return acoustics::ModemPort(protocol, options, port, WholeParameter("baud", 19200, 1, 1e7));
}

}  // namespace

DriverNode::DriverNode()
    : vehicle_(TextParameter("vehicle", "auv_0")),
      id_(WholeParameter("id", 0, 0, 253)),
      sound_speed_mps_(NumberParameter("sound_speed", 1500.0, 1300.0, 1700.0)),
      port_(OpenModem(id_)),
      desk_("/" + vehicle_ + "/" + topics::kAcousticPing),
      health_("modem of " + vehicle_, port_.name(), [this](auto& status) { Report(status); }) {
  ros::NodeHandle node;
  const std::string below = "/" + vehicle_ + "/";
  receptions_ = node.advertise<auv_msgs::AcousticReception>(below + topics::kAcousticRx, kQueue);
  statuses_ = node.advertise<TransmitStatus>(below + topics::kAcousticStatus, kQueue);
  packets_ = node.subscribe(below + topics::kAcousticTx, kQueue, &DriverNode::OnPacket, this);
}

void DriverNode::Spin() {
  const std::vector<acoustics::ModemPort*> ports{&port_};
  while (ros::ok()) {
    acoustics::ModemPort::Serve(ports, acoustics::SteadyNow() + kLook);
    start_ = NsOf(ros::Time::now()) - acoustics::SteadyNow();
    HandleMessages(0.0);
    AskRanges();
    TellReceptions();
    TellEvents();
    TellRanges();
    health_.Tick();
  }
}

void DriverNode::OnPacket(const auv_msgs::AcousticPacket::ConstPtr& message) {
  if (message->data.empty()) return;  // nothing to send
  const bool all = message->destination == acoustics::kToAll;
  if (!all &&
      (message->destination < 0 || message->destination > 253 || message->destination == id_)) {
    refused_.Add(Refusals::kMalformed);
    return;
  }
  acoustics::DriverPacket packet;
  packet.tag = message->sequence;
  packet.destination = all ? acoustics::kToAll : message->destination + 1;
  packet.payload.assign(message->data.begin(), message->data.end());
  destinations_[packet.tag] = message->destination;
  port_.driver().Send(packet, acoustics::SteadyNow());
}

void DriverNode::AskRanges() {
  for (const PingDesk::Question& question : desk_.TakeQuestions()) {
    if (question.source != static_cast<std::uint32_t>(id_)) {
      desk_.Refuse(question.tag, "this node drives the modem of vehicle " + std::to_string(id_));
    } else if (asks_) {
      desk_.Refuse(question.tag, "another ping is not finished yet");
    } else if (question.destination > 253 || question.destination == question.source) {
      desk_.Refuse(question.tag, "no such vehicle");
    } else {
      asks_ = true;
      question_ = question.tag;
      port_.driver().Ping(static_cast<int>(question.destination) + 1, acoustics::SteadyNow());
    }
  }
}

void DriverNode::TellRanges() {
  for (const acoustics::ModemPort::Range& range : port_.TakeRanges()) {
    if (!asks_) continue;
    asks_ = false;
    if (range.one_way_s < 0.0) {
      desk_.Refuse(question_, "no answer");
      continue;
    }
    auv_msgs::Ping::Response answer;
    answer.success = true;
    answer.round_trip = 2.0 * range.one_way_s;
    answer.range = range.one_way_s * sound_speed_mps_;
    answer.stamp = ros::Time::now();
    desk_.Answer(question_, answer);
  }
}

void DriverNode::TellReceptions() {
  auv_msgs::AcousticReception message;
  for (const acoustics::DriverReception& r : port_.TakeReceptions()) {
    if (r.source < 1) continue;
    auv_msgs::ReceivedPacket& m = message.packets.emplace_back();
    m.source = static_cast<std::uint32_t>(r.source - 1);
    m.destination = r.destination == acoustics::kToAll ? acoustics::kToAll : id_;
    m.sequence = received_++;
    const TimeNs arrival = start_ + r.arrival;
    m.arrival = TimeOf(arrival);
    m.transmit = m.generation = TimeOf(arrival - static_cast<TimeNs>(r.airtime_s * 1e9));
    m.received_level_db = r.received_level_db;
    m.noise_level_db = r.noise_level_db;
    m.sinr_db = r.sinr_db;
    m.doppler_mps = r.doppler_mps;
    m.data.assign(r.payload.begin(), r.payload.end());
  }
  if (message.packets.empty()) return;
  message.header.stamp = message.packets.back().arrival;
  message.header.frame_id = vehicle_ + "/base_link";
  receptions_.publish(message);
}

TransmitStatus DriverNode::StatusOf(std::uint32_t tag, TimeNs t) const {
  TransmitStatus m;
  m.header.stamp = TimeOf(start_ + t);
  m.header.frame_id = vehicle_ + "/base_link";
  m.source = static_cast<std::uint32_t>(id_);
  const auto destination = destinations_.find(tag);
  m.destination = destination == destinations_.end() ? acoustics::kToAll : destination->second;
  m.sequence = tag;
  return m;
}

void DriverNode::TellEvents() {
  for (const Event& event : port_.TakeEvents()) {
    TransmitStatus m = StatusOf(event.tag, event.t);
    m.text = event.text;
    switch (event.kind) {
      case Event::Kind::kQueued:
        m.status = TransmitStatus::QUEUED;
        break;
      case Event::Kind::kSent:
        leaving_[event.tag] = event.t;  // it is reported with the airtime, when this is known
        continue;
      case Event::Kind::kSendEnd:
        m.status = TransmitStatus::SENT;
        m.airtime = event.airtime_s;
        m.modem_sequence = static_cast<std::uint32_t>(port_.driver().counts().sent - 1);
        m.transmit = TimeOf(start_ + leaving_[event.tag]);
        break;
      case Event::Kind::kDropped:
        m.status = TransmitStatus::DROPPED;
        m.reason = static_cast<std::uint8_t>(acoustics::DropReason::kQueue);
        break;
      case Event::Kind::kRefused:
        m.status = TransmitStatus::REFUSED;
        break;
    }
    statuses_.publish(m);
    if (event.kind == Event::Kind::kQueued) continue;
    destinations_.erase(event.tag);
    leaving_.erase(event.tag);
  }
}

void DriverNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const acoustics::ModemDriver& driver = port_.driver();
  if (driver.ready()) {
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, "the modem answers");
  } else {
    status.summary(diagnostic_msgs::DiagnosticStatus::WARN,
                   port_.connected() ? "the modem does not answer" : "no connection");
  }
  const acoustics::ModemDriver::Counts& counts = driver.counts();
  status.add("firmware", driver.firmware());
  status.add("connections", counts.connections);
  status.add("packets sent", counts.sent);
  status.add("packets received", counts.received);
  status.add("receptions lost", counts.lost);
  status.add("packets dropped", counts.dropped);
  status.add("packets refused", counts.refused);
  refused_.Report(topics::kAcousticTx, &status);
}

}  // namespace stg::nodes

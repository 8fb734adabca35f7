#include <diagnostic_msgs/DiagnosticStatus.h>

#include <algorithm>

#include "acoustic_channel/nodes/conversions.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/nodes/topics.hpp"
#include "fleet_node.hpp"

/// Output to vehicles, observers and the log.
namespace stg::nodes {

using acoustics::DropReason;
using acoustics::PacketFate;
using acoustics::PacketInfo;
using auv_msgs::TransmitStatus;
using diagnostic_msgs::DiagnosticStatus;

void FleetNode::OnBegin(TimeNs start) {
  ++runs_;
  reports_.Begin(start);
  log_ = files_.Begin(start);
}

void FleetNode::OnReceptions(int vehicle, const std::vector<acoustics::Reception>& received) {
  auv_msgs::AcousticReception& m = reception_message_;
  m.header.stamp = TimeOf(std::max(fleet_.start() + received.back().arrival, TimeNs{0}));
  m.header.frame_id = vehicles_[static_cast<std::size_t>(vehicle)].name + "/base_link";
  m.packets.resize(received.size());
  for (std::size_t k = 0; k < received.size(); ++k) {
    SetReceivedPacket(received[k], fleet_.start(), &m.packets[k]);
    m.packets[k].source = static_cast<std::uint32_t>(reports_.IdOf(received[k].source));
    m.packets[k].destination = reports_.IdOf(received[k].destination);
  }
  receptions_ += received.size();
  members_[static_cast<std::size_t>(vehicle)].reception.publish(m);
}

TransmitStatus FleetNode::StatusOf(int vehicle, TimeNs stamp) const {
  TransmitStatus m;
  m.header.stamp = TimeOf(stamp);
  m.header.frame_id = vehicles_[static_cast<std::size_t>(vehicle)].name + "/base_link";
  m.source = static_cast<std::uint32_t>(reports_.IdOf(vehicle));
  return m;
}

TransmitStatus FleetNode::StatusOf(const PacketInfo& packet, TimeNs stamp) const {
  TransmitStatus m = StatusOf(packet.source, stamp);
  m.destination = reports_.IdOf(packet.destination);
  m.sequence = packet.tag;
  return m;
}

void FleetNode::PublishStatus(int vehicle, const TransmitStatus& status) {
  members_[static_cast<std::size_t>(vehicle)].status.publish(status);
}

void FleetNode::OnAbsent(const acoustics::Transmission& packet) {
  TransmitStatus m = StatusOf(packet.source, packet.stamp);
  m.destination = reports_.IdOf(packet.destination);
  m.sequence = packet.tag;
  RefusePacket(packet.source, &m, Refusals::kStale, "no odometry: the vehicle is not there");
}

void FleetNode::OnQueued(const PacketInfo& packet) {
  reports_.OnQueued(packet);
  if (log_ != nullptr) log_->OnQueued(packet);
  if (packet.kind != acoustics::PacketKind::kData) return;
  TransmitStatus m = StatusOf(packet, fleet_.start() + packet.offered);
  m.status = TransmitStatus::QUEUED;
  m.text = "queued";
  PublishStatus(packet.source, m);
}

void FleetNode::OnDiscarded(const PacketInfo& packet, DropReason reason, TimeNs t) {
  reports_.OnDiscarded(packet, reason, t);
  if (log_ != nullptr) log_->OnDiscarded(packet, reason, t);
  if (packet.kind != acoustics::PacketKind::kData) return;
  TransmitStatus m = StatusOf(packet, fleet_.start() + t);
  m.status = TransmitStatus::DROPPED;
  m.reason = static_cast<std::uint8_t>(reason);
  m.text = acoustics::ToString(reason);
  PublishStatus(packet.source, m);
}

void FleetNode::OnSent(const PacketInfo& packet) {
  reports_.OnSent(packet);
  if (log_ != nullptr) log_->OnSent(packet);
  if (packet.kind != acoustics::PacketKind::kData) return;
  TransmitStatus m = StatusOf(packet, fleet_.start() + packet.transmit);
  m.status = TransmitStatus::SENT;
  m.modem_sequence = packet.sequence;
  m.transmit = TimeOf(fleet_.start() + packet.transmit);
  m.airtime = Seconds(packet.transmit_end - packet.transmit);
  m.text = "sent";
  PublishStatus(packet.source, m);
}

void FleetNode::OnFate(const PacketInfo& packet, const PacketFate& fate) {
  reports_.OnFate(packet, fate);
  if (log_ != nullptr) log_->OnFate(packet, fate);
}

void FleetNode::OnPing(const acoustics::PingResult& result) {
  auv_msgs::Ping::Response answer;
  answer.success = result.answered;
  answer.message = result.answered   ? ""
                   : result.replaced ? "replaced by a later ping of the same vehicle"
                                     : "no answer";
  answer.range = result.range_m;
  answer.round_trip = result.round_trip_s;
  answer.stamp = TimeOf(fleet_.start() + result.ended);
  pings_.Answer(result.tag, answer);
}

void FleetNode::OnPingRefused(std::uint32_t tag, const std::string& why) {
  pings_.Refuse(tag, why);
}

void FleetNode::Tell() {
  auv_msgs::PacketEvents& events = reports_.message();
  if (!events.events.empty() && events_.getNumSubscribers() > 0) {
    events.header.stamp = TimeOf(fleet_.closed());
    events.header.frame_id = frames::kWorld;
    events_.publish(events);
  }
  reports_.Clear();
  files_.Flush();
  if (fleet_.begun()) PublishLinks();
}

void FleetNode::PublishLinks() {
  const ros::WallTime wall = ros::WallTime::now();
  if ((wall - links_sent_).toSec() < display_period_s_) return;
  links_sent_ = wall;
  auv_msgs::LinkStates& m = links_message_;
  m.header.stamp = TimeOf(fleet_.closed());
  m.header.frame_id = frames::kWorld;
  m.links.clear();
  for (int i = 0; i < fleet_.vehicles(); ++i) {
    for (int j = 0; j < fleet_.vehicles(); ++j) {
      if (i == j || !fleet_.heard_of(i) || !fleet_.heard_of(j)) continue;
      auv_msgs::LinkState& link = m.links.emplace_back();
      SetLinkState(fleet_.channel().Link(i, j, fleet_.closed() - fleet_.start()), &link);
      link.source = static_cast<std::uint32_t>(reports_.IdOf(i));
      link.destination = static_cast<std::uint32_t>(reports_.IdOf(j));
    }
  }
  links_.publish(m);
}

void FleetNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(DiagnosticStatus::OK, "running");
  status.add("runs", runs_);
  status.add("odometry taken", odometry_);
  status.add("packets taken", packets_);
  status.add("receptions", receptions_);
  refused_odometry_.Report("odom", &status);
  refused_packets_.Report(topics::kAcousticTx, &status);
  status.add("last refusal", last_refusal_);
  if (now_ == 0) {
    status.mergeSummary(DiagnosticStatus::WARN, "no time yet: no node publishes /clock");
    return;
  }
  if (fleet_.begun()) {
    status.addf("channel time [s]", "%.3f", Seconds(fleet_.closed()));
    status.add("channel behind the clock [s]", Seconds(now_ - fleet_.closed()));
    const acoustics::ChannelTotals& totals = fleet_.channel().totals();
    status.add("packets delivered in this run", totals.delivered);
    for (std::size_t k = 1; k < totals.drops.size(); ++k) {
      status.add(std::string("packets dropped: ") + acoustics::ToString(static_cast<DropReason>(k)),
                 totals.drops[k]);
    }
  }
  if (frames_.size() > 1) {
    std::string names;
    for (const std::string& name : frames_) names += (names.empty() ? "" : ", ") + name;
    status.mergeSummary(DiagnosticStatus::WARN, "odometry in different frames: " + names);
  }
  ReportVehicles(&status);
}

void FleetNode::ReportVehicles(diagnostic_updater::DiagnosticStatusWrapper* status) const {
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    const FleetVehicle& v = vehicles_[i];
    const int vehicle = static_cast<int>(i);
    const bool heard = fleet_.heard_of(vehicle);
    const bool here = fleet_.begun() && fleet_.present(vehicle);
    status->add(v.name, here ? "here" : heard ? "silent" : "no odometry yet");
    if (members_[i].late > 0) status->add(v.name + ": packets that came in late", members_[i].late);
    if (here) continue;
    status->mergeSummary(DiagnosticStatus::WARN,
                         heard ? v.name + " is silent" : "no odometry on " + v.odom);
  }
}

}  // namespace stg::nodes

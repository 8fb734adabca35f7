#include "acoustic_channel/nodes/packet_reports.hpp"

#include <utility>

#include "auv_common/nodes/conversions.hpp"

namespace stg::nodes {

using acoustics::DropReason;
using acoustics::PacketFate;
using acoustics::PacketInfo;
using auv_msgs::PacketEvent;

PacketReports::PacketReports(std::vector<int> ids) : ids_(std::move(ids)) {}

PacketEvent& PacketReports::Add(std::uint8_t kind, const PacketInfo& packet) {
  PacketEvent& e = message_.events.emplace_back();
  e.kind = kind;
  e.ranging = packet.kind != acoustics::PacketKind::kData;
  e.source = static_cast<std::uint32_t>(IdOf(packet.source));
  e.receiver = acoustics::kToAll;
  e.destination = IdOf(packet.destination);
  e.sequence = packet.sequence;
  e.tag = packet.tag;
  e.bytes = static_cast<std::uint32_t>(packet.bytes);
  e.offered = TimeOf(start_ + packet.offered);
  return e;
}

void PacketReports::OnQueued(const PacketInfo& packet) { Add(PacketEvent::QUEUED, packet); }

void PacketReports::OnDiscarded(const PacketInfo& packet, DropReason reason, TimeNs /*t*/) {
  Add(PacketEvent::DROPPED, packet).reason = static_cast<std::uint8_t>(reason);
}

void PacketReports::OnSent(const PacketInfo& packet) {
  PacketEvent& e = Add(PacketEvent::SENT, packet);
  e.transmit = TimeOf(start_ + packet.transmit);
  e.airtime = Seconds(packet.transmit_end - packet.transmit);
}

void PacketReports::OnFate(const PacketInfo& packet, const PacketFate& fate) {
  const bool delivered = fate.reason == DropReason::kNone;
  PacketEvent& e = Add(delivered ? PacketEvent::DELIVERED : PacketEvent::DROPPED, packet);
  e.reason = static_cast<std::uint8_t>(fate.reason);
  e.receiver = IdOf(fate.receiver);
  e.transmit = TimeOf(start_ + packet.transmit);
  e.airtime = Seconds(packet.transmit_end - packet.transmit);
  e.arrival = TimeOf(start_ + fate.arrival);
  e.distance = fate.distance_m;
  e.received_level_db = fate.received_level_db;
  e.noise_level_db = fate.noise_level_db;
  e.sinr_db = fate.sinr_db;
  e.loss_probability = fate.loss_probability;
}

}  // namespace stg::nodes

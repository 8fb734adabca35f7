#include "acoustic_channel/log/packet_log.hpp"

#include <charconv>
#include <utility>

#include "acoustic_channel/link/link_statistics.hpp"
#include "acoustic_channel/modem/modem_profile.hpp"

namespace stg::acoustics {
namespace {

const char* KindName(PacketKind kind) {
  switch (kind) {
    case PacketKind::kData:
      return "data";
    case PacketKind::kPing:
      return "ping";
    case PacketKind::kReply:
      return "reply";
    case PacketKind::kAck:
      return "ack";
    case PacketKind::kControl:
      return "control";
  }
  return "?";
}

}  // namespace

PacketLog::PacketLog(std::ostream* out, int nodes, std::vector<std::string> names, TimeNs offset)
    : out_(out), nodes_(nodes), names_(std::move(names)), offset_(offset) {
  *out_ << "source,destination,addressed,kind,sequence,bytes,offered_s,generation_s,transmit_s,"
           "transmit_end_s,begin_s,arrival_s,distance_m,travel_time_s,received_level_db,"
           "noise_level_db,sinr_db,error_probability,fate,mode\n";
}

void PacketLog::OnDiscarded(const PacketInfo& packet, DropReason reason, TimeNs /*t*/) {
  if (packet.destination == kToNone) return;
  if (packet.destination != kToAll) {
    Row(packet, nullptr, packet.destination, reason);
    return;
  }
  for (int i = 0; i < nodes_; ++i) {
    if (i != packet.source) Row(packet, nullptr, i, reason);
  }
}

void PacketLog::OnFate(const PacketInfo& packet, const PacketFate& fate) {
  Row(packet, &fate, fate.receiver, fate.reason);
}

void PacketLog::Row(const PacketInfo& packet, const PacketFate* fate, int receiver,
                    DropReason reason) {
  row_.clear();
  Node(packet.source);
  Comma();
  Node(receiver);
  Comma();
  if (packet.destination == kToAll) {
    row_ += "all";
  } else {
    Node(packet.destination);
  }
  Comma();
  row_ += KindName(packet.kind);
  Comma();
  if (packet.sequence != kNoSequence) Integer(packet.sequence);
  Comma();
  Integer(static_cast<long long>(packet.bytes));
  Comma();
  Time(packet.offered);
  Comma();
  Time(packet.generation);
  if (fate != nullptr) {
    for (const TimeNs t : {packet.transmit, packet.transmit_end, fate->begin, fate->arrival}) {
      Comma();
      Time(t);
    }
    Comma();
    Number(fate->distance_m, 3);
    Comma();
    Number(fate->travel_time_s, 9);
    for (const double level : {fate->received_level_db, fate->noise_level_db, fate->sinr_db}) {
      Comma();
      Number(level, 3);
    }
    Comma();
    Number(fate->loss_probability, 6);
  } else {
    row_.append(10, ',');
  }
  Comma();
  row_ += reason == DropReason::kNone ? "delivered" : ToString(reason);
  Comma();
  if (packet.mode != nullptr) row_ += packet.mode->name;
  row_ += '\n';
  out_->write(row_.data(), static_cast<std::streamsize>(row_.size()));
  ++rows_;
}

void PacketLog::Node(int node) {
  if (names_.empty()) {
    Integer(node);
  } else {
    row_ += names_[static_cast<std::size_t>(node)];
  }
}

/// Writes seconds with all nine digits, from whole numbers, so nothing is rounded.
void PacketLog::Time(TimeNs t) {
  constexpr TimeNs kSecond = 1'000'000'000;
  TimeNs ns = t + offset_;
  if (ns < 0) {
    row_ += '-';
    ns = -ns;
  }
  Integer(ns / kSecond);
  const std::string digits = std::to_string(ns % kSecond);
  row_ += '.';
  row_.append(9 - digits.size(), '0');
  row_ += digits;
}

/// Never writes -0.
void PacketLog::Number(double value, int decimals) {
  char text[400];
  const auto end =
      std::to_chars(text, text + sizeof(text), value + 0.0, std::chars_format::fixed, decimals);
  row_.append(text, end.ptr);
}

void PacketLog::Integer(long long value) {
  char text[24];
  const auto end = std::to_chars(text, text + sizeof(text), value);
  row_.append(text, end.ptr);
}

}  // namespace stg::acoustics

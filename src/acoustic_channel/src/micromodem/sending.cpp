#include <algorithm>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/micromodem/micromodem.hpp"

/// Frames from the host to the water.
namespace stg::acoustics::micromodem {
namespace {

PacketKind KindOf(PacketType type) {
  switch (type) {
    case PacketType::kPlain:
    case PacketType::kData:
    case PacketType::kFlexible:
      return PacketKind::kData;
    case PacketType::kAck:
      return PacketKind::kAck;
    case PacketType::kCycle:
    case PacketType::kPing:
    case PacketType::kReply:
    case PacketType::kMini:
    case PacketType::kLbl:
      break;
  }
  return PacketKind::kControl;
}

/// Mini-packets contain 13 bits and count as two bytes.
bool Mini(const PacketHeader& header) {
  return header.type != PacketType::kData && header.type != PacketType::kFlexible;
}

bool Automatic(PacketType type) { return type == PacketType::kReply || type == PacketType::kAck; }

}  // namespace

void Micromodem::AskForFrame(TimeNs t) {
  const PacketHeader& h = cycle_.header;
  Enter(State::kDataRequest, t + std::max(1, setting("DTO")) * kSecondNs);
  Say({"CADRQ", FormatUtc(Utc(t), "%H%M%S"), std::to_string(h.source),
       std::to_string(h.destination), h.acks != 0 ? "1" : "0",
       std::to_string(modes_.rate(h.rate).frame_bytes), std::to_string(cycle_.frames.size() + 1)});
}

void Micromodem::SendFrames(TimeNs t) {
  std::vector<std::string>& frames = cycle_.frames;
  if (frames.empty()) {
    TellTransmission(cycle_.header, PacketInfo(), 4, t);
    return Enter(State::kIdle, kNever);
  }
  PacketHeader header = cycle_.header;
  header.type = PacketType::kData;
  header.frames = static_cast<int>(frames.size());
  header.frame_bytes = static_cast<int>(frames.front().size());
  std::string payload, lengths;
  for (const std::string& frame : frames) {
    payload += frame;
    lengths += static_cast<char>(frame.size() & 0xff);
    const bool last = &frame == &frames.back();
    const bool like_first = static_cast<int>(frame.size()) == header.frame_bytes;
    if (!like_first && !(last && static_cast<int>(frame.size()) < header.frame_bytes)) {
      header.uneven = true;
    }
  }
  if (header.uneven) payload += lengths;
  const std::size_t air_bytes = frames.size() * modes_.rate(header.rate).frame_bytes;
  Enter(State::kDataTx, t + kSendingTimeout);
  Transmit(header, payload, air_bytes, t);
}

void Micromodem::Transmit(const PacketHeader& header, const std::string& payload,
                          std::size_t air_bytes, TimeNs t) {
  if (setting("SNV") != 1) return TransmitNow(header, payload, air_bytes);
  synchronous_ = {NextSecond(t), header, payload, air_bytes};
}

void Micromodem::TransmitNow(const PacketHeader& header, const std::string& payload,
                             std::size_t air_bytes) {
  const bool data = !Mini(header);
  Transmission packet;
  packet.kind = KindOf(header.type);
  packet.destination =
      header.destination == options_.broadcast ? kToAll : world_->NodeOf(header.destination);
  packet.tag = ++tag_;
  packet.mode = data ? &modes_.rate(header.rate) : &modes_.mini(setting("MOD") == 1);
  packet.air_bytes = air_bytes;
  packet.header = Pack(header);
  packet.payload = {reinterpret_cast<const std::uint8_t*>(payload.data()), payload.size()};
  world_->Send(packet);
}

void Micromodem::OnSent(const PacketInfo& packet, TimeNs t) {
  const PacketHeader header = Unpack(packet.header);
  Say({"CATXP", std::to_string(Mini(header) ? 2 : packet.bytes)});
  if (header.type == PacketType::kPing) {
    ping_.sent = t;
    ping_.airtime = packet.transmit_end - packet.transmit;
  }
}

void Micromodem::OnSendEnd(const PacketInfo& packet, TimeNs t) {
  const PacketHeader header = Unpack(packet.header);
  Say({"CATXF", std::to_string(Mini(header) ? 2 : packet.bytes)});
  if (Automatic(header.type)) return;
  if (header.type != PacketType::kPing) TellTransmission(header, packet, 0, t);
  if (header.type == PacketType::kCycle && state_ == State::kCycleTx) {
    if (header.source == setting("SRC")) return AskForFrame(t);
    cycle_.header = header;
    return Enter(State::kHeardCycle, t + std::max(1, setting("CTO")) * kSecondNs);
  }
  if (state_ == State::kDataTx || state_ == State::kPacketTx) Enter(State::kIdle, kNever);
}

}  // namespace stg::acoustics::micromodem

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/micromodem/micromodem.hpp"

/// Events of the water, and the modem's reports about them to its host.
namespace stg::acoustics::micromodem {
namespace {

bool Psk(const PacketInfo& packet) { return IsPsk(packet.mode); }

/// The frames of a packet, in order.
std::vector<std::string> Split(const PacketHeader& header,
                               const std::vector<std::uint8_t>& payload) {
  const std::size_t count = static_cast<std::size_t>(header.frames);
  std::string bytes(payload.begin(), payload.end());
  std::vector<std::size_t> lengths(count, static_cast<std::size_t>(header.frame_bytes));
  if (header.uneven && bytes.size() >= count) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto length = static_cast<unsigned char>(bytes[bytes.size() - count + k]);
      lengths[k] = length == 0 ? 256 : length;
    }
    bytes.resize(bytes.size() - count);
  }
  std::vector<std::string> frames;
  std::size_t at = 0;
  for (const std::size_t length : lengths) {
    frames.push_back(bytes.substr(std::min(at, bytes.size()), length));
    at += length;
  }
  return frames;
}

}  // namespace

void Micromodem::Handle(const ModemEvent& event) {
  if (IsLbl(event.packet)) return HandleLbl(event);
  switch (event.kind) {
    case ModemEvent::Kind::kSent:
      return OnSent(event.packet, event.t);
    case ModemEvent::Kind::kSendEnd:
      return OnSendEnd(event.packet, event.t);
    case ModemEvent::Kind::kDiscarded:
      if (state_ == State::kCycleTx || state_ == State::kDataTx || state_ == State::kPacketTx) {
        Enter(State::kIdle, kNever);
      }
      return;
    case ModemEvent::Kind::kAcquired:
      if (state_ != State::kBoot && setting("RXP") != 0) {
        Say({"CARXP", Psk(event.packet) ? "1" : "0"});
      }
      return;
    case ModemEvent::Kind::kReceptionEnd:
      if (state_ != State::kBoot) OnReceptionEnd(event);
      return;
  }
}

PacketHeader Micromodem::HeaderOf(const ModemEvent& event) const {
  PacketHeader h = Unpack(event.packet.header);
  if (h.type != PacketType::kPlain) return h;
  // The packet of an ordinary vehicle is a set of frames at its profile's rate.
  h.source = world_->AddressOf(event.packet.source);
  h.destination = event.packet.destination == kToAll ? options_.broadcast
                                                     : world_->AddressOf(event.packet.destination);
  h.rate = event.packet.mode == nullptr ? 0 : std::max(0, RateOf(*event.packet.mode));
  h.frame_bytes = static_cast<int>(modes_.rate(h.rate).frame_bytes);
  h.frames = static_cast<int>(modes_.rate(h.rate).frames(event.packet.bytes));
  h.type = PacketType::kData;
  return h;
}

bool Micromodem::forMe(const PacketHeader& header) const {
  return header.destination == setting("SRC") || header.destination == options_.broadcast;
}

void Micromodem::OnReceptionEnd(const ModemEvent& event) {
  const DropReason reason = event.end.fate.reason;
  if (reason == DropReason::kLeft) return;
  const PacketHeader header = HeaderOf(event);
  if (reason != DropReason::kNone) {
    TellLoss(header, event);
    TellReception(header, event);
    return;
  }
  const std::string source = std::to_string(header.source);
  const std::string destination = std::to_string(header.destination);
  switch (header.type) {
    case PacketType::kCycle:
      TakeCycle(header, event.t);
      TellReception(header, event);
      if (state_ == State::kDataRequest) AskForFrame(event.t);
      return;
    case PacketType::kPlain:
    case PacketType::kData:
    case PacketType::kFlexible:
      TakeFrames(header, event);
      break;
    case PacketType::kPing:
      if (!forMe(header)) break;
      Say({"CAMPA", source, destination});
      if (header.destination == setting("SRC")) {
        PacketHeader reply;
        reply.type = PacketType::kReply;
        reply.source = header.destination;
        reply.destination = header.source;
        answers_.push_back({event.t + world_->profile().turnaround(), reply});
      }
      break;
    case PacketType::kReply:
      TakeReply(header, event);
      break;
    case PacketType::kMini:
      if (forMe(header) && event.payload.size() == 2) {
        Say({"CAMUA", source, destination,
             ToHex(std::string(event.payload.begin(), event.payload.end()))});
      }
      break;
    case PacketType::kAck:
      TakeAck(header);
      break;
    case PacketType::kLbl:
      break;  // handled before
  }
  TellReception(header, event);
}

void Micromodem::TellCycle(const PacketHeader& header) {
  Say({"CACYC", std::to_string(header.poller_command), std::to_string(header.source),
       std::to_string(header.destination), std::to_string(header.rate),
       header.acks != 0 ? "1" : "0", std::to_string(header.frames)});
}

void Micromodem::TakeCycle(const PacketHeader& header, TimeNs t) {
  TellCycle(header);
  if (state_ != State::kIdle && state_ != State::kHeardCycle) return;
  cycle_ = {};
  cycle_.header = header;
  cycle_.wanted = header.frames;
  const bool polled = header.source == setting("SRC");
  if (polled) {
    // After the report of the poll, it asks for its first frame.
    Enter(State::kDataRequest, kNever);
  } else {
    Enter(State::kHeardCycle, t + std::max(1, setting("CTO")) * kSecondNs);
  }
}

void Micromodem::TakeFrames(const PacketHeader& header, const ModemEvent& event) {
  if (state_ == State::kHeardCycle) Enter(State::kIdle, kNever);
  const std::string source = std::to_string(header.source);
  const std::string destination = std::to_string(header.destination);
  const std::vector<std::string> frames = Split(header, event.payload);
  const std::string asked = header.acks != 0 ? "1" : "0";
  if (header.type == PacketType::kFlexible) {
    if (!forMe(header)) return;
    std::string all;
    for (const std::string& frame : frames) all += frame;
    Say({"CARDP", source, destination, std::to_string(header.rate), asked, "0", "",
         "1;" + std::to_string(all.size()) + ";" +
             (setting("recv.base64data") == 1 ? ToBase64(all) : ToHex(all))});
  } else {
    if (Psk(event.packet)) TellCycle(header);
    for (std::size_t k = 0; k < frames.size() && forMe(header); ++k) {
      Say({header.text ? "CARXA" : "CARXD", source, destination,
           (header.acks >> k & 1) != 0 ? "1" : "0", std::to_string(k + 1),
           header.text ? frames[k] : ToHex(frames[k])});
    }
  }
  if (header.acks == 0 || header.destination != setting("SRC")) return;
  PacketHeader ack;
  ack.type = PacketType::kAck;
  ack.source = header.destination;
  ack.destination = header.source;
  ack.frames = header.frames;
  ack.acks = header.acks;
  answers_.push_back({event.t + world_->profile().turnaround(), ack});
}

void Micromodem::TakeReply(const PacketHeader& header, const ModemEvent& event) {
  if (header.destination != setting("SRC") || !ping_.open || header.source != ping_.destination) {
    return;
  }
  ping_.open = false;
  const PacketFate& fate = event.end.fate;
  const double watched_s = world_->ClockS(event.t) - world_->ClockS(ping_.sent);
  const double known_s =
      Seconds(ping_.airtime) + Seconds(fate.arrival - fate.begin) + world_->profile().turnaround_s;
  char seconds[40];
  std::snprintf(seconds, sizeof(seconds), "%.4f", std::max(0.0, 0.5 * (watched_s - known_s)));
  Say({"CAMPR", std::to_string(header.source), std::to_string(header.destination), seconds});
}

void Micromodem::TakeAck(const PacketHeader& header) {
  if (header.destination != setting("SRC")) return;
  for (int k = 0; k < header.frames; ++k) {
    if ((header.acks >> k & 1) == 0) continue;
    Say({"CAACK", std::to_string(header.source), std::to_string(header.destination),
         std::to_string(k + 1), "1"});
  }
}

void Micromodem::TellLoss(const PacketHeader& header, const ModemEvent& event) {
  const bool data = header.type == PacketType::kData || header.type == PacketType::kFlexible;
  if (data && state_ == State::kHeardCycle) Enter(State::kIdle, kNever);
  if (event.end.fate.reason == DropReason::kHalfDuplex) {
    Say({"CAMSG", "PACKET_TIMEOUT", std::to_string(header.rate)});
    return;
  }
  // In PSK, the header of a packet has its own code; we assume that the modem has decoded it.
  // Without CACYC, host software such as Goby does not count the frames as bad.
  if (header.type == PacketType::kData && Psk(event.packet)) TellCycle(header);
  const int frames = header.type == PacketType::kData ? std::max(1, header.frames) : 1;
  for (int k = 1; k <= frames; ++k) Say({"CAMSG", "BAD_CRC", std::to_string(k)});
}

}  // namespace stg::acoustics::micromodem

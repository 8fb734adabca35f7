#include <algorithm>
#include <cmath>
#include <cstdio>

#include "acoustic_channel/s2c/s2c_modem.hpp"

/// Events of the water, and the modem's reports about them to its host.
namespace stg::acoustics::s2c {
namespace {

constexpr int kGood = 100;  ///< integrity of a signal that is just strong enough
constexpr int kBest = 999;

std::uint32_t Microseconds(TimeNs t) { return static_cast<std::uint32_t>((t + 500) / 1000); }

const char* TypeName(const PacketHeader& h) {
  switch (h.type) {
    case MessageType::kPlain:
    case MessageType::kIm:
      return "im";
    case MessageType::kIms:
      return "ims";
    case MessageType::kAck:
      return h.piggyback ? "pbm" : "ack";
    case MessageType::kConnect:
    case MessageType::kAccept:
    case MessageType::kBurst:
    case MessageType::kBurstAck:
    case MessageType::kClose:
      break;
  }
  return "burst";
}

std::string Join(std::initializer_list<std::string> fields) {
  std::string text;
  for (const std::string& field : fields) text += (text.empty() ? "" : ",") + field;
  return text;
}

}  // namespace

void S2cModem::Handle(const ModemEvent& event) {
  switch (event.kind) {
    case ModemEvent::Kind::kSent:
      OnSent(event.packet, event.t);
      break;
    case ModemEvent::Kind::kSendEnd:
      OnSendEnd(event.packet, event.t);
      break;
    case ModemEvent::Kind::kDiscarded:
      // The modem has taken it back, or the vehicle has left. No host is notified.
      if (message_ && message_->tag == event.packet.tag &&
          message_->step == Message::Step::kOffered) {
        message_.reset();
      }
      if (event.packet.tag == burst_tag_) {
        burst_tag_ = 0;
        connection_.OnDiscarded(event.t);
      }
      break;
    case ModemEvent::Kind::kAcquired:
      receiving_ = true;
      if (state_ != State::kDeaf && settings_.at("ZX") != 0) Notify("RECVSTART");
      break;
    case ModemEvent::Kind::kReceptionEnd:
      receiving_ = false;
      if (state_ != State::kDeaf) OnReceptionEnd(event);
      Launch(event.t);
      LaunchBurst(event.t);
      break;
  }
}

void S2cModem::OnSent(const PacketInfo& packet, TimeNs t) {
  sending_ = true;
  ++sent_count_;
  if (message_ && message_->tag == packet.tag) {
    message_->step = Message::Step::kSending;
    message_->sent = t;
    message_->airtime = packet.transmit_end - packet.transmit;
  }
  if (settings_.at("ZX") == 0) return;
  const PacketHeader h = Unpack(packet.header);
  Notify(Join({"SENDSTART", std::to_string(h.destination), TypeName(h),
               std::to_string(Microseconds(packet.transmit_end - packet.transmit)), "0"}));
}

void S2cModem::OnSendEnd(const PacketInfo& packet, TimeNs t) {
  sending_ = false;
  const PacketHeader h = Unpack(packet.header);
  if (settings_.at("ZX") != 0) {
    Notify(Join({"SENDEND", std::to_string(h.destination), TypeName(h),
                 std::to_string(ClockUs(packet.transmit)),
                 std::to_string(Microseconds(packet.transmit_end - packet.transmit))}));
  }
  if (!acks_.empty() && acks_.front().tag == packet.tag) acks_.pop_front();
  if (message_ && message_->tag == packet.tag && message_->step == Message::Step::kSending) {
    if (message_->header.flag == Flag::kAck) {
      message_->step = Message::Step::kAwaitingAck;
      message_->deadline = t + static_cast<TimeNs>(settings_.at("RT")) * 1'000'000;
    } else {
      message_.reset();
    }
  }
  if (packet.tag == burst_tag_) {
    burst_tag_ = 0;
    connection_.OnSendEnd(packet.transmit, t);
  }
  LaunchAck(t);
  Launch(t);
  LaunchBurst(t);
}

PacketHeader S2cModem::HeaderOf(const PacketInfo& packet) const {
  PacketHeader h = Unpack(packet.header);
  if (h.type != MessageType::kPlain) return h;
  h.source = world_->AddressOf(packet.source);
  h.destination =
      packet.destination == kToAll ? options_.broadcast : world_->AddressOf(packet.destination);
  return h;
}

void S2cModem::Measure(const ModemEvent& event, bool failed) {
  const PacketFate& fate = event.end.fate;
  const double margin_db = fate.sinr_db - world_->profile().acquisition_db;
  measured_.rssi = static_cast<int>(std::lround(fate.received_level_db + options_.rssi_offset_db));
  const double quality = std::clamp(kGood + 6.0 * margin_db, 0.0, static_cast<double>(kBest));
  measured_.integrity = static_cast<int>(std::lround(quality));
  if (failed) measured_.integrity = std::min(measured_.integrity, kGood - 1);
  measured_.velocity_mps = event.end.closing_mps;
  measured_.duration_us = Microseconds(fate.arrival - fate.begin);
  measured_.delay_level_db = 100.0;
}

std::string S2cModem::Signal() const {
  char velocity[40];
  std::snprintf(velocity, sizeof(velocity), "%.4f", measured_.velocity_mps);
  return Join({std::to_string(measured_.duration_us), std::to_string(measured_.rssi),
               std::to_string(measured_.integrity), velocity});
}

void S2cModem::OnReceptionEnd(const ModemEvent& event) {
  const PacketKind kind = event.packet.kind;
  if (event.end.fate.reason == DropReason::kLeft) return;
  const bool failed = event.end.fate.reason != DropReason::kNone;
  Measure(event, failed);
  const bool extended = settings_.at("ZX") != 0;
  if (failed) {
    char velocity[40];
    std::snprintf(velocity, sizeof(velocity), "%.4f", measured_.velocity_mps);
    if (extended) {
      Notify(Join({"RECVFAILED", velocity, std::to_string(measured_.rssi),
                   std::to_string(measured_.integrity)}));
    }
    return;
  }
  if (extended) {
    Notify(Join({"RECVEND", std::to_string(ClockUs(event.end.fate.begin)),
                 std::to_string(measured_.duration_us), std::to_string(measured_.rssi),
                 std::to_string(measured_.integrity)}));
  }
  if (kind == PacketKind::kPing || kind == PacketKind::kReply) return;
  const PacketHeader header = HeaderOf(event.packet);
  const bool mine = header.destination == settings_.at("AL");
  if (header.type == MessageType::kAck) {
    if (mine) TakeAck(header, event);
  } else if (header.type > MessageType::kAck) {
    if (mine && state_ == State::kListen) TakeConnectionPacket(header, event);
  } else {
    TakeMessage(header, event);
  }
}

void S2cModem::TakeMessage(const PacketHeader& header, const ModemEvent& event) {
  const bool mine = header.destination == settings_.at("AL");
  const bool wanted = mine || header.destination == options_.broadcast || settings_.at("RP") != 0;
  if (!wanted) return;
  ++received_count_;
  const std::string payload(event.payload.begin(), event.payload.end());
  std::string length = std::to_string(payload.size());
  if (settings_.at("ZF") != 0) length = "p" + std::to_string(header.pid) + "," + length;
  const std::string source = std::to_string(header.source);
  const std::string destination = std::to_string(header.destination);
  if (header.type == MessageType::kIms) {
    Notify(Join({"RECVIMS", length, source, destination,
                 std::to_string(ClockUs(event.end.fate.begin)), Signal(), payload}));
    return;
  }
  const char* flag = header.flag == Flag::kAck     ? "ack"
                     : header.flag == Flag::kForce ? "force"
                                                   : "noack";
  Notify(Join({"RECVIM", length, source, destination, flag, Signal(), payload}));
  if (!mine || header.flag != Flag::kAck || state_ != State::kListen) return;
  Ack ack;
  ack.header.type = MessageType::kAck;
  ack.header.source = settings_.at("AL");
  ack.header.destination = header.source;
  ack.due = event.t + world_->profile().turnaround();
  acks_.push_back(ack);
}

void S2cModem::TakeAck(const PacketHeader& header, const ModemEvent& event) {
  if (header.piggyback) {
    const std::string payload(event.payload.begin(), event.payload.end());
    std::string length = std::to_string(payload.size());
    if (settings_.at("ZF") != 0) length = "p" + std::to_string(header.pid) + "," + length;
    Notify(Join({"RECVPBM", length, std::to_string(header.source),
                 std::to_string(header.destination), Signal(), payload}));
  }
  if (!message_ || message_->step != Message::Step::kAwaitingAck ||
      message_->header.destination != header.source) {
    return;
  }
  const TimeNs ack_airtime = event.end.fate.arrival - event.end.fate.begin;
  const double watched_s = world_->ClockS(event.t) - world_->ClockS(message_->sent);
  const double known_s =
      Seconds(message_->airtime) + Seconds(ack_airtime) + world_->profile().turnaround_s;
  measured_.propagation_us =
      static_cast<std::uint32_t>(std::max(0LL, std::llround((watched_s - known_s) * 0.5e6)));
  GiveUp("DELIVERED");
}

}  // namespace stg::acoustics::s2c

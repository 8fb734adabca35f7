#include <algorithm>
#include <cmath>
#include <cstdio>

#include "acoustic_channel/s2c/s2c_modem.hpp"

/// Burst data and the acoustic connection.
namespace stg::acoustics::s2c {

ModemProfile BurstMode(const ModemProfile& own) {
  ModemProfile p = own;
  p.name += "_burst";
  p.frame_s = 8.0 / kBurstBitrate;
  p.frame_bytes = 1;
  p.max_frames = kLongestBurst;
  p.spreading_db = 10.0 * std::log10(1e3 * p.bandwidth_khz / kBurstBitrate);
  // Keeps the ratio of energy to noise per bit.
  p.errors.half_db += own.spreading_db - p.spreading_db;
  return p;
}

void S2cModem::HeedSettings() {
  ConnectionSettings s;
  s.address = settings_.at("AL");
  s.repeats = settings_.at("RC");
  s.patience = static_cast<TimeNs>(settings_.at("RT")) * 1'000'000;
  s.idle = static_cast<TimeNs>(settings_.at("KO")) * 1'000'000'000;
  s.pool_bytes = static_cast<std::size_t>(settings_.at("PS"));
  connection_.Heed(s);
}

std::string S2cModem::SendBurst(const PacketHeader& header, const std::string& payload, TimeNs t) {
  if (WrongDestination(header.destination, false)) return "ERROR WRONG DESTINATION ADDRESS";
  HeedSettings();
  return connection_.Add(header.destination, header.pid, payload, t);
}

void S2cModem::TakeRaw(const std::string& bytes, TimeNs t) {
  const int remote = settings_.at("AR");
  if (WrongDestination(remote, false) || state_ != State::kListen) return;  // the data is dropped
  HeedSettings();
  for (std::size_t at = 0; at < bytes.size(); at += kLongestBurst) {
    const std::string answer = connection_.AddRaw(remote, bytes.substr(at, kLongestBurst), t);
    if (answer != "OK") Notify(answer);
  }
  LaunchBurst(t);
}

bool S2cModem::ControlConnection(const std::string& text, TimeNs t) {
  HeedSettings();
  if (text == "Z1") {
    connection_.Close(false);
    connection_.Clear();
  } else if (text == "Z4") {
    connection_.Clear();
  } else if (text == "H" || text == "H0") {
    connection_.Close(true);
  } else if (text == "H1") {
    connection_.Close(false);
  } else if (!text.empty() && text[0] == 'D') {
    const auto destination = WholeNumber(text.substr(1));
    if (!destination || *destination > 255) {
      Answer("D", "ERROR WRONG FORMAT");
    } else if (WrongDestination(static_cast<int>(*destination), false)) {
      Answer("D", "ERROR WRONG DESTINATION ADDRESS");
    } else {
      Answer(text, connection_.Dial(static_cast<int>(*destination), t));
    }
    return true;
  } else {
    return false;
  }
  Answer(text, "OK");
  return true;
}

/// Instant messages and acknowledgements have priority.
void S2cModem::LaunchBurst(TimeNs t) {
  if (burst_tag_ != 0 || sending_ || receiving_ || message_ || !acks_.empty()) return;
  if (state_ != State::kListen) return;
  HeedSettings();
  const auto out = connection_.Next(t);
  if (!out) return;
  burst_tag_ = ++tag_;
  const bool data = out->header.type == MessageType::kBurst;
  Transmission packet;
  packet.kind = data ? PacketKind::kData : PacketKind::kControl;
  packet.destination = world_->NodeOf(out->header.destination);
  packet.tag = burst_tag_;
  if (data) packet.mode = &burst_mode_;
  packet.level_db = SourceLevelDb(settings_.at("L"));
  packet.header = Pack(out->header);
  packet.payload = {reinterpret_cast<const std::uint8_t*>(out->payload.data()),
                    out->payload.size()};
  world_->Send(packet);
}

void S2cModem::TakeConnectionPacket(const PacketHeader& header, const ModemEvent& event) {
  HeedSettings();
  const auto answer = [&](MessageType type) {
    Ack ack;
    ack.header.type = type;
    ack.header.source = settings_.at("AL");
    ack.header.destination = header.source;
    ack.header.number = header.number;
    ack.due = event.t + world_->profile().turnaround();
    acks_.push_back(ack);
  };
  const auto propagation_us = [&] {
    const TimeNs airtimes =
        connection_.ended() - connection_.began() + event.end.fate.arrival - event.end.fate.begin;
    const double watched_s = world_->ClockS(event.t) - world_->ClockS(connection_.began());
    const double known_s = Seconds(airtimes) + world_->profile().turnaround_s;
    return static_cast<std::uint32_t>(std::max(0LL, std::llround((watched_s - known_s) * 0.5e6)));
  };
  bool fresh = false;
  switch (header.type) {
    case MessageType::kConnect:
      if (connection_.TakeConnect(header.source, event.t)) answer(MessageType::kAccept);
      break;
    case MessageType::kAccept:
      if (!connection_.TakeAccept(header.source, event.t)) break;
      measured_.propagation_us = propagation_us();
      connection_.SetPropagation(measured_.propagation_us);
      break;
    case MessageType::kBurst:
      if (!connection_.TakeBurst(header, event.t, &fresh)) break;
      answer(MessageType::kBurstAck);
      if (fresh) TellBurst(header, event);
      break;
    case MessageType::kBurstAck:
      connection_.TakeBurstAck(header, event.t);
      break;
    case MessageType::kClose:
      connection_.TakeClose(header.source);
      break;
    case MessageType::kPlain:
    case MessageType::kIm:
    case MessageType::kIms:
    case MessageType::kAck:
      break;
  }
}

void S2cModem::TellBurst(const PacketHeader& header, const ModemEvent& event) {
  ++received_count_;
  const std::string payload(event.payload.begin(), event.payload.end());
  if (header.raw && reader_.mode() == Reader::Mode::kData) {
    if (connected_) world_->Write(payload);
    return;
  }
  std::string length = std::to_string(payload.size());
  if (settings_.at("ZF") != 0) length = "p" + std::to_string(header.pid) + "," + length;
  char velocity[40];
  std::snprintf(velocity, sizeof(velocity), "%.4f", measured_.velocity_mps);
  Notify("RECV," + length + "," + std::to_string(header.source) + "," +
         std::to_string(header.destination) + "," + std::to_string(std::lround(kBurstBitrate)) +
         "," + std::to_string(measured_.rssi) + "," + std::to_string(measured_.integrity) + "," +
         std::to_string(header.propagation_us) + "," + velocity + "," + payload);
}

}  // namespace stg::acoustics::s2c

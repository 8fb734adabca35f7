#include <algorithm>
#include <vector>

#include "acoustic_channel/s2c/s2c_modem.hpp"

/// Sending of instant, synchronous and piggyback messages.
namespace stg::acoustics::s2c {
namespace {

constexpr std::size_t kLongestIm = 64;
/// A synchronous message is not sent if it is later than this [us].
constexpr std::int32_t kLate_us = 1000;
constexpr char kBusy[] = "BUSY DELIVERING MESSAGE";

std::vector<std::string> Split(const std::string& text) {
  std::vector<std::string> fields;
  std::size_t at = 0;
  for (;;) {
    const std::size_t comma = text.find(',', at);
    fields.push_back(text.substr(at, comma == std::string::npos ? comma : comma - at));
    if (comma == std::string::npos) return fields;
    at = comma + 1;
  }
}

const char* TypeName(MessageType type) { return type == MessageType::kIms ? "IMS" : "IM"; }

}  // namespace

bool S2cModem::WrongDestination(int address, bool broadcast) const {
  if (address == options_.broadcast) return !broadcast;
  return address < 1 || address > settings_.at("AM") || address == settings_.at("AL");
}

void S2cModem::Send(const Item& item, TimeNs t) {
  std::vector<std::string> fields = Split(item.text);
  const std::string name = fields[0];
  fields.erase(fields.begin());
  PacketHeader header;
  header.source = settings_.at("AL");
  header.pid = settings_.at("PID");
  if (fields[0][0] == 'p') {
    const auto pid = WholeNumber(fields[0].substr(1));
    if (!pid) return Answer(name, "ERROR WRONG FORMAT");
    if (*pid > 255) return Answer(name, "ERROR PROTOCOL ID");
    header.pid = static_cast<int>(*pid);
    fields.erase(fields.begin());
  }
  const auto destination = WholeNumber(fields[1]);
  if (!destination) return Answer(name, "ERROR WRONG FORMAT");
  if (*destination > 255) return Answer(name, "ERROR WRONG DESTINATION ADDRESS");
  header.destination = static_cast<int>(*destination);
  const bool burst = name == "*SEND";
  if (item.payload.empty() || (!burst && item.payload.size() > kLongestIm)) {
    return Answer(name, "ERROR OUT OF RANGE");
  }
  if (state_ != State::kListen) return Answer(name, "ERROR NOT ACCEPTED");
  std::string answer;
  if (burst) {
    answer = SendBurst(header, item.payload, t);
  } else if (name == "*SENDPBM") {
    answer = SendPbm(header, item.payload);
  } else if (name == "*SENDIMS") {
    answer = SendIms(header, item.payload, fields[2], t);
  } else {
    answer = SendIm(header, item.payload, fields[2], t);
  }
  Answer(name, answer);
  if (answer != "OK") return;
  if (burst) return LaunchBurst(t);
  if (message_ && message_->timed && message_->start < t) {
    GiveUp("EXPIRED");
    return;
  }
  Launch(t);
}

std::string S2cModem::SendIm(PacketHeader header, const std::string& payload,
                             const std::string& flag, TimeNs /*t*/) {
  header.type = MessageType::kIm;
  if (flag == "ack") {
    header.flag = Flag::kAck;
  } else if (flag == "force") {
    header.flag = Flag::kForce;
  } else if (flag != "noack") {
    return "ERROR WRONG FORMAT";
  }
  if (WrongDestination(header.destination, header.flag != Flag::kAck)) {
    return "ERROR WRONG DESTINATION ADDRESS";
  }
  if (message_) return kBusy;
  if (connection_.state() == Connection::State::kBackoff && header.flag != Flag::kForce) {
    return "BUSY BACKOFF STATE";
  }
  message_ = Message();
  message_->header = header;
  message_->payload = payload;
  message_->retries_left = settings_.at("RI");
  return "OK";
}

std::string S2cModem::SendIms(PacketHeader header, const std::string& payload,
                              const std::string& clock, TimeNs t) {
  header.type = MessageType::kIms;
  if (WrongDestination(header.destination, true)) return "ERROR WRONG DESTINATION ADDRESS";
  const auto start_us = WholeNumber(clock);
  if (!start_us && !clock.empty()) return "ERROR WRONG FORMAT";
  if (message_) return kBusy;
  message_ = Message();
  message_->header = header;
  message_->payload = payload;
  if (!start_us) return "OK";
  message_->timed = true;
  const auto wait_us = static_cast<std::int32_t>(*start_us - ClockUs(t));
  message_->start = wait_us < -kLate_us ? t - 1 : std::max(t, TimeOfClock(*start_us, t));
  return "OK";
}

std::string S2cModem::SendPbm(const PacketHeader& header, const std::string& payload) {
  if (WrongDestination(header.destination, false)) return "ERROR WRONG DESTINATION ADDRESS";
  if (!piggyback_.emplace(header.destination, payload).second) return kBusy;
  return "OK";
}

void S2cModem::Launch(TimeNs t) {
  if (!message_ || message_->step != Message::Step::kWaiting) return;
  Message& m = *message_;
  if (m.timed && t < m.start) return;
  if (m.timed && sending_) return GiveUp("EXPIRED");
  if (!m.timed && (sending_ || !acks_.empty())) return;
  if (!m.timed && receiving_ && options_.defer) return;
  m.step = Message::Step::kOffered;
  m.tag = ++tag_;
  Transmission packet;
  const int address = m.header.destination;
  packet.destination = address == options_.broadcast ? kToAll : world_->NodeOf(address);
  packet.tag = m.tag;
  packet.level_db = SourceLevelDb(settings_.at("L"));
  packet.header = Pack(m.header);
  packet.payload = {reinterpret_cast<const std::uint8_t*>(m.payload.data()), m.payload.size()};
  world_->Send(packet);
}

void S2cModem::LaunchAck(TimeNs t) {
  if (acks_.empty() || acks_.front().tag != 0 || t < acks_.front().due || sending_) return;
  Ack& ack = acks_.front();
  ack.tag = ++tag_;
  std::string payload(1, '\0');
  const auto waiting = piggyback_.find(ack.header.destination);
  if (ack.header.type == MessageType::kAck && waiting != piggyback_.end()) {
    payload = waiting->second;
    ack.header.piggyback = true;
    piggyback_.erase(waiting);
  }
  Transmission packet;
  packet.kind = PacketKind::kAck;
  packet.destination = world_->NodeOf(ack.header.destination);
  packet.tag = ack.tag;
  packet.air_bytes = ack.header.piggyback ? 1 + payload.size() : 1;
  packet.level_db = SourceLevelDb(settings_.at("L"));
  packet.header = Pack(ack.header);
  packet.payload = {reinterpret_cast<const std::uint8_t*>(payload.data()), payload.size()};
  world_->Send(packet);
}

void S2cModem::GiveUp(const std::string& word) {
  const PacketHeader header = message_->header;
  message_.reset();
  const std::string address = std::to_string(header.destination);
  if (header.flag == Flag::kAck && word != "CANCELED") delivery_ = word + "," + address;
  Notify(word + TypeName(header.type) + "," + address);
}

void S2cModem::DropMessages(bool tell) {
  if (message_) {
    world_->TakeBack(message_->tag);
    if (tell) {
      GiveUp("CANCELED");
    } else {
      message_.reset();
    }
  }
  for (const auto& waiting : piggyback_) {
    if (tell) Notify("CANCELEDPBM," + std::to_string(waiting.first));
  }
  piggyback_.clear();
  delivery_ = "EMPTY";
}

}  // namespace stg::acoustics::s2c

#include "acoustic_channel/janus/janus_modem.hpp"

#include <algorithm>
#include <cstdio>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/engine/text.hpp"

/// Lines from and to the host, and events of the water.
namespace stg::acoustics::janus {
namespace {

/// A packet that has not left after this time is lost; the longest packet takes 50 s.
constexpr TimeNs kSendingTimeout = 120'000'000'000;

std::string Fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

std::array<std::uint8_t, kBaselineBytes> BaselineOf(const std::vector<std::uint8_t>& payload) {
  std::array<std::uint8_t, kBaselineBytes> bytes{};
  std::copy_n(payload.begin(), std::min(payload.size(), kBaselineBytes), bytes.begin());
  return bytes;
}

}  // namespace

void LineReader::Reset() {
  buffer_.clear();
  skipping_ = false;
}

void LineReader::Feed(ByteView bytes) {
  buffer_.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
}

std::optional<LineReader::Line> LineReader::Next() {
  for (;;) {
    const std::size_t end = buffer_.find_first_of("\r\n");
    if (skipping_) {
      buffer_.erase(0, end == std::string::npos ? end : end + 1);
      if (end == std::string::npos) return {};
      skipping_ = false;
      continue;
    }
    if (std::min(end, buffer_.size()) > kLongestLine) {
      skipping_ = true;
      return Line{};
    }
    if (end == std::string::npos) return {};
    const std::string text = buffer_.substr(0, end);
    buffer_.erase(0, end + 1);
    if (!text.empty()) return Line{text};
  }
}

JanusModem::JanusModem(const ModemOptions& options, ModemSurroundings* world)
    : options_(options), world_(world), with_cargo_(world->profile()) {
  // Cargo comes after the baseline packet, whose airtime is in the profile. The bytes of the cargo
  // are frames, too.
  with_cargo_.name += "_cargo";
  with_cargo_.preamble_s +=
      with_cargo_.frame_s + kCargoByte_s * (1.0 - static_cast<double>(kBaselineBytes));
  with_cargo_.frame_s = kCargoByte_s;
  with_cargo_.frame_bytes = 1;
  with_cargo_.max_frames = kLargestFrame;
}

void JanusModem::Start(TimeNs t) {
  power_on_ = t;
  reader_.Reset();
  sending_ = receiving_ = false;
  world_->SetAddress(options_.station);
}

void JanusModem::Connect(TimeNs /*t*/) {
  connected_ = true;
  reader_.Reset();
}
void JanusModem::Disconnect(TimeNs /*t*/) {
  connected_ = false;
  reader_.Reset();
}

void JanusModem::Read(TimeNs t, ByteView bytes) {
  reader_.Feed(bytes);
  while (const auto line = reader_.Next()) {
    if (line->text) {
      Obey(*line->text, t);
    } else {
      Say("error line too long");
    }
  }
}

void JanusModem::Say(const std::string& line) {
  if (connected_) world_->Write(line + "\r\n");
}

void JanusModem::Obey(const std::string& line, TimeNs t) {
  try {
    const std::size_t end = std::min(line.find(' '), line.size());
    const std::string command = line.substr(0, end);
    if (command == "tx") return Transmit(WordsOf(line.substr(end)), t);
    const bool known = command == "status" || command == "version";
    if (known && line.find_first_not_of(' ', end) != std::string::npos) {
      throw Refusal{"words behind a command that takes none"};
    }
    if (command == "status") {
      Say(std::string("status ") + (sending_ ? "sending" : receiving_ ? "receiving" : "idle"));
    } else if (command == "version") {
      Say("version " + std::to_string(kVersion));
    } else {
      throw Refusal{"unknown command"};
    }
  } catch (const Refusal& refusal) {
    Say("error " + refusal.why);
  }
}

void JanusModem::Transmit(const Words& words, TimeNs t) {
  if (sending_) throw Refusal{"busy"};
  const Packet packet = PacketOf(words);
  const auto baseline = Encode(packet);
  std::string payload(baseline.begin(), baseline.end());
  Say("ok packet=" + ToHex(payload));
  payload += packet.cargo;
  Transmission sound;
  sound.tag = ++tag_;
  if (!packet.cargo.empty()) sound.mode = &with_cargo_;
  sound.payload = {reinterpret_cast<const std::uint8_t*>(payload.data()), payload.size()};
  sending_ = true;
  give_up_ = t + kSendingTimeout;
  world_->Send(sound);
}

void JanusModem::Handle(const ModemEvent& event) {
  switch (event.kind) {
    case ModemEvent::Kind::kSent:
      Say("sending airtime=" +
          Fixed(Seconds(event.packet.transmit_end - event.packet.transmit), 3));
      return;
    case ModemEvent::Kind::kSendEnd:
      sending_ = false;
      return Say("sent");
    case ModemEvent::Kind::kDiscarded:
      sending_ = false;
      return;
    case ModemEvent::Kind::kAcquired:
      receiving_ = true;
      return Say("detected after=" + Fixed(world_->ClockS(event.t) - world_->ClockS(power_on_), 6));
    case ModemEvent::Kind::kReceptionEnd:
      receiving_ = false;
      return OnReceptionEnd(event);
  }
}

void JanusModem::OnReceptionEnd(const ModemEvent& event) {
  const PacketFate& fate = event.end.fate;
  if (fate.reason == DropReason::kLeft) return;
  const std::string signal =
      " level=" + Fixed(fate.received_level_db, 1) + " noise=" + Fixed(fate.noise_level_db, 1) +
      " snr=" + Fixed(fate.sinr_db, 1) + " speed=" + Fixed(event.end.closing_mps, 3) +
      " after=" + Fixed(world_->ClockS(fate.begin) - world_->ClockS(power_on_), 6);
  const auto baseline = BaselineOf(event.payload);
  std::optional<Packet> packet;
  if (fate.reason == DropReason::kNone) packet = Decode(baseline);
  if (!packet) {
    // Lost, or the bytes of an ordinary vehicle, which are not a packet of the standard.
    Say("lost" + signal);
    return;
  }
  if (event.payload.size() > kBaselineBytes) {
    packet->cargo.assign(event.payload.begin() + kBaselineBytes, event.payload.end());
  }
  Say("rx" + Tell(*packet) + signal +
      " packet=" + ToHex(std::string(baseline.begin(), baseline.end())));
}

TimeNs JanusModem::next() const { return sending_ ? give_up_ : kNever; }

void JanusModem::Tick(TimeNs t) {
  if (!sending_ || t < give_up_) return;
  sending_ = false;
  world_->TakeBack(tag_);
}

}  // namespace stg::acoustics::janus

#include "acoustic_channel/s2c/s2c_modem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "acoustic_channel/access/medium_access.hpp"

/// Lines from and to the host, and time.
namespace stg::acoustics::s2c {
namespace {

constexpr TimeNs kGuard = 1'000'000'000;     ///< silence around a single "+++"
constexpr TimeNs kPatience = 5'000'000'000;  ///< longest wait for the rest of a message
constexpr TimeNs kAckPatience = 1'000'000'000;

}  // namespace

S2cModem::S2cModem(const ModemOptions& options, ModemSurroundings* world)
    : options_(options),
      world_(world),
      connection_([this](const std::string& text) { Notify(text); }),
      burst_mode_(BurstMode(world->profile())) {
  for (const auto& [name, value] : options.settings) settings_.Set(name, value);
  settings_.Set("AL", std::to_string(options.address));
  settings_.Store();
}

void S2cModem::Start(TimeNs t) {
  power_on_ = t;
  settings_.Restore();
  world_->SetAddress(settings_.at("AL"));
  SetMode(options_.net ? Reader::Mode::kPlain : Reader::Mode::kData);
  reader_.Reset();
  state_ = State::kListen;
  sending_ = receiving_ = false;
  // A host that is still connected is notified that its messages have ended.
  if (message_ && message_->step >= Message::Step::kSending) GiveUp("FAILED");
  DropMessages(true);
  acks_.clear();
  if (burst_tag_ != 0) world_->TakeBack(burst_tag_);
  burst_tag_ = 0;
  connection_.Reset();
  delivery_ = "EMPTY";
  measured_ = {};
}

void S2cModem::Reboot(TimeNs t) {
  const bool connected = std::exchange(connected_, false);  // nothing more is sent to the host
  Start(t);
  connected_ = connected;
  world_->HangUp();
}

void S2cModem::Connect(TimeNs t) {
  connected_ = true;
  silence_ = t;
  reader_.Reset();
  SetMode(options_.net ? Reader::Mode::kPlain : Reader::Mode::kData);
}

void S2cModem::Disconnect(TimeNs /*t*/) {
  connected_ = awaits_silence_ = false;
  reader_.Reset();
}

void S2cModem::SetMode(Reader::Mode mode) { reader_.SetMode(mode); }

void S2cModem::Read(TimeNs t, ByteView bytes) {
  if (bytes.size == 0) return;
  silence_ = t;
  reader_.Feed(bytes);
  Work(t);
}

void S2cModem::Work(TimeNs t) {
  while (const std::optional<Item> item = reader_.Next()) Obey(*item, t);
  awaits_silence_ = reader_.awaits_silence() || reader_.inside_message();
}

void S2cModem::Obey(const Item& item, TimeNs t) {
  if (item.kind == Item::Kind::kData) return TakeRaw(item.payload, t);
  const std::string name = NameOf(item.text);
  // The interpreter of plain lines does not know escapes.
  if (item.kind == Item::Kind::kBroken ||
      (item.escaped && reader_.mode() == Reader::Mode::kPlain)) {
    Answer(name, "ERROR WRONG FORMAT");
  } else if (item.kind == Item::Kind::kTooLong) {
    Answer(name, "ERROR OUT OF RANGE");
  } else if (item.kind == Item::Kind::kMessage) {
    Send(item, t);
  } else {
    Command(item.text, t);
  }
}

void S2cModem::Answer(const std::string& name, const std::string& text) {
  world_->Write(Framed(reader_.mode(), name, text));
}

void S2cModem::AnswerLines(const std::string& name, const std::string& lines) {
  // Each line ends with a line feed only, and the whole answer with carriage return and line feed.
  // EviNS looks for both at the end, and dune takes everything before them as one line.
  Answer(name, lines);
}

void S2cModem::Notify(const std::string& text) {
  if (!connected_) return;
  Answer("", text);
  world_->Announce(text);
}

std::uint32_t S2cModem::ClockUs(TimeNs t) const {
  const double s = world_->ClockS(t) - world_->ClockS(power_on_);
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::llround(s * 1e6)));
}

TimeNs S2cModem::TimeOfClock(std::uint32_t clock_us, TimeNs t) const {
  const auto wait_us = static_cast<std::int32_t>(clock_us - ClockUs(t));
  const double target_s = world_->ClockS(t) + 1e-6 * wait_us;
  TimeNs guess = t + static_cast<TimeNs>(wait_us) * 1000;
  for (int k = 0; k < 2; ++k) guess += std::llround((target_s - world_->ClockS(guess)) * 1e9);
  return guess;
}

TimeNs S2cModem::next() const {
  TimeNs first = kNever;
  if (awaits_silence_) first = silence_ + (reader_.inside_message() ? kPatience : kGuard);
  if (!acks_.empty()) {
    const Ack& ack = acks_.front();
    const bool free = ack.tag == 0 && !sending_;
    first = std::min(first, free ? ack.due : ack.due + kAckPatience);
  }
  if (message_) {
    if (message_->step == Message::Step::kAwaitingAck) first = std::min(first, message_->deadline);
    if (message_->step == Message::Step::kWaiting && message_->timed) {
      first = std::min(first, message_->start);
    }
  }
  return std::min(first, connection_.next());
}

void S2cModem::Tick(TimeNs t) {
  if (awaits_silence_ && t >= silence_ + kGuard && !reader_.inside_message()) {
    if (reader_.OnSilence()) {
      SetMode(Reader::Mode::kPlain);
      Answer("", "OK");
    }
    awaits_silence_ = false;
  }
  if (awaits_silence_ && t >= silence_ + kPatience) {
    reader_.GiveUp();
    awaits_silence_ = false;
    Answer("", "ERROR WRONG FORMAT");
  }
  while (!acks_.empty() && t >= acks_.front().due + kAckPatience) {
    world_->TakeBack(acks_.front().tag);
    acks_.pop_front();
  }
  LaunchAck(t);
  connection_.Tick(t);
  LaunchBurst(t);
  if (!message_) return;
  Message& m = *message_;
  if (m.step == Message::Step::kAwaitingAck && t >= m.deadline) {
    if (m.retries_left == 0) {
      ++failed_count_;
      GiveUp("FAILED");
    } else {
      if (m.retries_left < 255) --m.retries_left;
      m.step = Message::Step::kWaiting;
    }
  }
  Launch(t);
  LaunchBurst(t);
}

}  // namespace stg::acoustics::s2c

#include "acoustic_channel/micromodem/micromodem.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "acoustic_channel/access/medium_access.hpp"

/// Lines from and to the host, and time.
namespace stg::acoustics::micromodem {
namespace {

constexpr TimeNs kBootTime = kSecondNs;
constexpr TimeNs kRevisionPeriod = 60 * kSecondNs;

}  // namespace

std::string FormatUtc(TimeNs utc, const char* format, int decimals) {
  const TimeNs second = utc / kSecondNs - (utc % kSecondNs < 0 ? 1 : 0);
  const std::time_t whole = static_cast<std::time_t>(second);
  std::tm parts{};
  gmtime_r(&whole, &parts);
  char text[64];
  const std::size_t length = std::strftime(text, sizeof(text), format, &parts);
  std::string out(text, length);
  if (decimals == 0) return out;
  const std::string digits = std::to_string(kSecondNs + (utc - second * kSecondNs));
  return out + "." + digits.substr(1, static_cast<std::size_t>(decimals));
}

Micromodem::Micromodem(const ModemOptions& options, ModemSurroundings* world)
    : options_(options), world_(world), modes_(world->profile()), pps_(options.pps) {
  ListenForReplies(false);
  SetDefaults();
  for (const auto& [key, value] : options_.settings) settings_[key] = value;
}

void Micromodem::Start(TimeNs t) {
  settings_["SRC"] = std::to_string(options_.address);
  Reboot(t);
}

void Micromodem::Reboot(TimeNs t) {
  reader_.Reset();
  cycle_ = {};
  ping_ = {};
  ListenForReplies(false);
  answers_.clear();
  synchronous_.reset();
  world_->SetAddress(setting("SRC"));
  // Takes back everything that was given to the water and has not left. These are the last few
  // tags.
  for (std::uint32_t tag = tag_ > 8 ? tag_ - 8 : 0; tag <= tag_; ++tag) world_->TakeBack(tag);
  Enter(State::kBoot, t + kBootTime);
  revision_ = kNever;
}

void Micromodem::Connect(TimeNs /*t*/) {
  connected_ = true;
  reader_.Reset();
}
void Micromodem::Disconnect(TimeNs /*t*/) {
  connected_ = false;
  reader_.Reset();
}

void Micromodem::Read(TimeNs t, ByteView bytes) {
  reader_.Feed(bytes);
  while (const std::optional<Sentence> sentence = reader_.Next()) {
    if (state_ != State::kBoot) Obey(*sentence, t);
  }
}

void Micromodem::Say(const std::vector<std::string>& fields) {
  if (connected_) world_->Write(Seal(Join(fields)));
}

void Micromodem::Error(TimeNs t, const std::string& module, int number, const std::string& text) {
  Say({"CAERR", FormatUtc(Utc(t), "%H%M%S"), module, std::to_string(number), text});
}

void Micromodem::Enter(State state, TimeNs until) {
  state_ = state;
  deadline_ = until;
}

TimeNs Micromodem::Utc(TimeNs t) const {
  if (pps_) return world_->utc_start() + t + clock_offset_;
  return world_->utc_start() + std::llround(world_->ClockS(t) * 1e9) + clock_offset_;
}

TimeNs Micromodem::NextSecond(TimeNs t) const {
  const TimeNs target = Utc(t) - Utc(t) % kSecondNs + kSecondNs;
  TimeNs guess = t + target - Utc(t);
  for (int k = 0; k < 2; ++k) guess += target - Utc(guess);
  return std::max(t, guess);
}

int Micromodem::clock_mode() const {
  constexpr int kUserCommand = 2, kExternal = 3;
  // Newer firmware reports the source of the time and, above these two bits, the source of the
  // tick.
  if (second_generation()) return (clock_set_ ? kUserCommand : 0) + (pps_ ? kExternal << 2 : 0);
  return (clock_set_ ? 1 : 0) + (pps_ ? 2 : 0);
}

int Micromodem::setting(const std::string& key) const {
  const auto found = settings_.find(key);
  if (found == settings_.end()) return 0;
  return NumberIn(found->second, -1'000'000, 1'000'000).value_or(0);
}

bool Micromodem::second_generation() const {
  return !options_.firmware.empty() && options_.firmware[0] >= '2' && options_.firmware[0] <= '9';
}

TimeNs Micromodem::next() const {
  TimeNs first = std::min(deadline_, revision_);
  if (!answers_.empty()) first = std::min(first, answers_.front().due);
  if (synchronous_) first = std::min(first, synchronous_->due);
  return first;
}

void Micromodem::Tick(TimeNs t) {
  if (t >= revision_) {
    const std::string time = FormatUtc(Utc(t), "%H%M%S");
    if (setting("REV") != 0) Say({"CAREV", time, "AUV", options_.firmware});
    revision_ = t + kRevisionPeriod;
  }
  while (!answers_.empty() && t >= answers_.front().due) {
    const PacketHeader header = answers_.front().header;
    answers_.pop_front();
    TransmitNow(header, std::string(1, '\0'), 0);
  }
  if (synchronous_ && t >= synchronous_->due) {
    const Synchronous packet = *std::exchange(synchronous_, std::nullopt);
    TransmitNow(packet.header, packet.payload, packet.air_bytes);
  }
  if (t < deadline_) return;
  switch (state_) {
    case State::kBoot:
      Say({"CAREV", FormatUtc(Utc(t), "%H%M%S"), "INIT", options_.firmware});
      revision_ = t + kBootTime;
      break;
    case State::kDataRequest: {
      Say({"CAERR", FormatUtc(Utc(t), "%H%M%S"), "DATA_TIMEOUT",
           std::to_string(cycle_.frames.size() + 1)});
      PacketInfo nothing;
      TellTransmission(cycle_.header, nothing, 4, t);
      break;
    }
    case State::kHeardCycle:
      Say({"CAMSG", "PACKET_TIMEOUT", std::to_string(cycle_.header.rate)});
      break;
    case State::kRanging:
      return EndRanging(t);
    case State::kIdle:
    case State::kCycleTx:
    case State::kDataTx:
    case State::kPacketTx:
      break;
  }
  Enter(State::kIdle, kNever);
}

}  // namespace stg::acoustics::micromodem

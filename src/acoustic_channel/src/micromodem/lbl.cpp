#include "acoustic_channel/micromodem/lbl.hpp"

#include <algorithm>
#include <cstdio>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/micromodem/micromodem.hpp"

/// The modem's side of LBL ranging.
namespace stg::acoustics::micromodem {
namespace {

constexpr int kLongestTimeoutMs = 60'000;
constexpr int kLongestPingMs = 50;
constexpr int kHighestHz = 100'000;

}  // namespace

/// CCPDT,group,channel,sync,sync timeout,timeout,A,B,C,D pings a REMUS network.
/// CCPNT,ping Hz,ping ms,reply ms,timeout,A,B,C,D,flag pings narrowband transponders; A to D are
/// the frequencies of their replies, 0: nothing is expected. Timeouts in ms.
bool Micromodem::CommandLbl(const std::vector<std::string>& fields, TimeNs t) {
  if (fields.size() != 10) return false;
  const bool remus = fields[0] == "CCPDT";
  std::array<int, 9> n{};
  for (std::size_t k = 0; k < n.size(); ++k) {
    const auto number = NumberIn(fields[k + 1], 0, kHighestHz);
    if (!number) return false;
    n[k] = *number;
  }
  LblRanging ranging;
  const int timeout_ms = remus ? n[4] : n[3];
  if (timeout_ms < 1 || timeout_ms > kLongestTimeoutMs) return false;
  ranging.timeout = timeout_ms * (kSecondNs / 1000);
  int ping_ms = kRemusPingMs;
  if (remus) {
    // There is one group, and nothing is connected that could synchronise the ping.
    const bool sound = n[0] == 1 && n[1] >= 1 && n[1] <= 4 && n[2] == 0 &&
                       std::all_of(n.begin() + 5, n.end(), [](int flag) { return flag <= 1; });
    if (!sound) return false;
    ranging.ping.channel = n[1];
  } else {
    ping_ms = n[1];
    if (n[0] < 1 || ping_ms < 1 || ping_ms > kLongestPingMs || n[8] != 1) return false;
    ranging.ping.hz = n[0];
  }
  std::copy_n(n.begin() + (remus ? 5 : 4), kLblSlots, ranging.wanted.begin());
  std::vector<std::string> echo = fields;
  echo[0].replace(0, 2, "SN");
  Say(echo);
  ranging_ = ranging;
  ListenForReplies(true);
  Enter(State::kRanging, t + kSendingTimeout);
  world_->Send(LblTransmission(ranging.ping, ping_ms, ++tag_, modes_));
  return true;
}

void Micromodem::ListenForReplies(bool listen) {
  std::vector<std::string> waveforms{"micromodem_fsk", "micromodem_psk"};
  if (listen) waveforms.push_back(modes_.lbl().waveform);
  world_->SetWaveforms(waveforms);
}

void Micromodem::HandleLbl(const ModemEvent& event) {
  if (state_ != State::kRanging) return;
  switch (event.kind) {
    case ModemEvent::Kind::kSent:
      ranging_.sent = event.t;
      ranging_.airtime = event.packet.transmit_end - event.packet.transmit;
      return Enter(State::kRanging, event.t + ranging_.timeout);
    case ModemEvent::Kind::kDiscarded:
      return EndRanging(event.t);
    case ModemEvent::Kind::kReceptionEnd:
      if (event.end.fate.reason == DropReason::kNone) TakeLblReply(event);
      return;
    case ModemEvent::Kind::kSendEnd:
    case ModemEvent::Kind::kAcquired:
      return;
  }
}

void Micromodem::TakeLblReply(const ModemEvent& event) {
  const LblSound reply = UnpackLbl(event.packet.header);
  if (!reply.reply || reply.channel != ranging_.ping.channel || !ranging_.sent) return;
  const double watched_s = world_->ClockS(event.end.fate.begin) - world_->ClockS(*ranging_.sent);
  const double known_s = Seconds(ranging_.airtime) + 1e-3 * setting("TAT");
  bool complete = true;
  for (int k = 0; k < kLblSlots; ++k) {
    const auto slot = static_cast<std::size_t>(k);
    const int wanted = ranging_.wanted[slot];
    const bool from_it = reply.channel > 0 ? reply.slot == k : reply.hz == wanted;
    std::optional<double>& travel_s = ranging_.travel_s[slot];
    if (wanted != 0 && from_it && !travel_s) travel_s = std::max(0.0, 0.5 * (watched_s - known_s));
    complete = complete && (wanted == 0 || travel_s);
  }
  if (complete) EndRanging(event.t);
}

/// SNTTA,A,B,C,D,time of the ping. A transponder that did not answer leaves its field empty.
void Micromodem::EndRanging(TimeNs t) {
  std::vector<std::string> fields{"SNTTA"};
  for (const std::optional<double>& travel_s : ranging_.travel_s) {
    char seconds[40] = "";
    if (travel_s) std::snprintf(seconds, sizeof(seconds), "%.4f", *travel_s);
    fields.emplace_back(seconds);
  }
  fields.push_back(FormatUtc(Utc(ranging_.sent.value_or(t)), "%H%M%S", 2));
  ListenForReplies(false);
  Enter(State::kIdle, kNever);
  Say(fields);
}

}  // namespace stg::acoustics::micromodem

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/micromodem/lbl.hpp"

/// The sounds of LBL ranging, and the transponders that answer them.
namespace stg::acoustics::micromodem {
namespace {

constexpr TimeNs kMillisecondNs = 1'000'000;
constexpr std::uint8_t kNoContent = 0;

}  // namespace

std::uint64_t Pack(const LblSound& sound) {
  const auto put = [](int value, int at) { return static_cast<std::uint64_t>(value) << at; };
  return put(static_cast<int>(PacketType::kLbl), 0) | put(sound.reply ? 1 : 0, 4) |
         put(sound.channel, 5) | put(sound.slot, 8) | put(sound.hz, 10);
}

LblSound UnpackLbl(std::uint64_t header) {
  const auto take = [header](int bits, int at) {
    return static_cast<int>(header >> at & ((std::uint64_t{1} << bits) - 1));
  };
  return {take(1, 4) != 0, take(3, 5), take(2, 8), take(20, 10)};
}

Transmission LblTransmission(const LblSound& sound, int ms, std::uint32_t tag, const Modes& modes) {
  Transmission packet;
  packet.kind = PacketKind::kControl;
  packet.tag = tag;
  packet.mode = &modes.lbl();
  packet.air_bytes = static_cast<std::size_t>(ms);
  packet.header = Pack(sound);
  packet.payload = {&kNoContent, 1};
  return packet;
}

Transponder::Transponder(const TransponderOptions& options, ModemSurroundings* world)
    : options_(options), world_(world), modes_(world->profile()) {
  world_->SetWaveforms({modes_.lbl().waveform});
}

void Transponder::Handle(const ModemEvent& event) {
  const bool heard = event.kind == ModemEvent::Kind::kReceptionEnd && IsLbl(event.packet) &&
                     event.end.fate.reason == DropReason::kNone;
  if (!heard) return;
  const LblSound ping = UnpackLbl(event.packet.header);
  const bool narrowband = options_.slot < 0;
  const bool asked =
      narrowband ? ping.channel == 0 && ping.hz == options_.query_hz : ping.channel > 0;
  if (ping.reply || !asked) return;
  LblSound reply;
  reply.reply = true;
  reply.channel = ping.channel;
  reply.slot = narrowband ? 0 : options_.slot;
  reply.hz = narrowband ? options_.reply_hz : 0;
  answers_.push_back({event.t + options_.turnaround_ms * kMillisecondNs, reply});
}

TimeNs Transponder::next() const { return answers_.empty() ? kNever : answers_.front().due; }

void Transponder::Tick(TimeNs t) {
  while (!answers_.empty() && t >= answers_.front().due) {
    world_->Send(LblTransmission(answers_.front().sound, kRemusPingMs, ++tag_, modes_));
    answers_.pop_front();
  }
}

}  // namespace stg::acoustics::micromodem

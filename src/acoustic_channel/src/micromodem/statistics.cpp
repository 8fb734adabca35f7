#include <cmath>
#include <cstdio>

#include "acoustic_channel/micromodem/micromodem.hpp"

/// CACST and CAXST: statistics of every reception and transmission for host software.
namespace stg::acoustics::micromodem {
namespace {

constexpr int kBadFrames = 3;  ///< error of PSK: the checksum of at least one frame is wrong

/// The modem's number of a kind of packet.
int NumberOf(PacketType type, int rate, const PacketInfo& packet) {
  switch (type) {
    case PacketType::kPlain:
    case PacketType::kData:
      return rate == 0 ? 1 : 3;
    case PacketType::kFlexible:
      return 5;
    case PacketType::kCycle:
    case PacketType::kPing:
    case PacketType::kReply:
    case PacketType::kMini:
    case PacketType::kAck:
    case PacketType::kLbl:
      break;
  }
  return IsPsk(packet.mode) ? 4 : 2;
}

std::string Whole(double value) { return std::to_string(std::lround(value)); }

}  // namespace

void Micromodem::TellReception(const PacketHeader& header, const ModemEvent& event) {
  const PacketFate& fate = event.end.fate;
  if (setting("TOA") == 1 && fate.reason == DropReason::kNone) {
    Say({"CATOA", FormatUtc(Utc(fate.begin), "%H%M%S", 4), std::to_string(clock_mode())});
  }
  if (setting("CST") == 0) return;
  const bool lost = fate.reason != DropReason::kNone;
  const int mode = fate.reason == DropReason::kHalfDuplex ? 2 : lost ? 1 : 0;
  const bool data = header.type == PacketType::kData || header.type == PacketType::kFlexible;
  const ModemProfile& sound = data ? modes_.rate(header.rate) : modes_.mini();
  const int frames = data ? header.frames : 1;
  const TimeNs begin = Utc(fate.begin);
  char doppler[40];
  std::snprintf(doppler, sizeof(doppler), "%.1f", event.end.closing_mps);
  const bool newer = second_generation();
  std::vector<std::string> fields{"CACST"};
  if (newer) fields.emplace_back("6");
  const std::string sinr = Whole(fate.sinr_db);
  const bool psk = data && header.rate != 0;
  const std::string rest[] = {
      std::to_string(mode),
      newer ? FormatUtc(begin, "%Y%m%d%H%M%S", 6) : FormatUtc(begin, "%H%M%S", 4),
      std::to_string(clock_mode()),
      "0",  // peak, power and ratio of the detector: not modelled
      "0",
      "0",
      Whole(fate.received_level_db),
      "0",  // gain and shifts: not modelled
      "0",
      "0",
      "0",
      "0",
      std::to_string(header.rate),
      std::to_string(header.source),
      std::to_string(header.destination),
      psk && mode == 1 ? std::to_string(kBadFrames) : "0",
      std::to_string(NumberOf(header.type, header.rate, event.packet)),
      std::to_string(frames),
      std::to_string(lost ? frames : 0),
      Whole(fate.received_level_db),
      sinr,
      sinr,  // at the equaliser's output; the equaliser is assumed to be perfect
      sinr,
      "0",
      lost ? "0" : "200",
      doppler,
      Whole(fate.noise_level_db),
      Whole(sound.centre_khz * 1e3),
      Whole(sound.bandwidth_khz * 1e3),
  };
  fields.insert(fields.end(), std::begin(rest), std::end(rest));
  Say(fields);
}

void Micromodem::TellTransmission(const PacketHeader& header, const PacketInfo& packet, int mode,
                                  TimeNs t) {
  if (setting("XST") == 0) return;
  const bool data = header.type == PacketType::kData || header.type == PacketType::kFlexible;
  const ModemProfile& sound = data ? modes_.rate(header.rate) : modes_.mini();
  // Start of the transmission; for a packet that never left, the present time.
  const TimeNs begin = Utc(mode == 0 ? packet.transmit : t);
  std::vector<std::string> fields{"CAXST"};
  if (second_generation()) fields.emplace_back("6");
  const int frames = data ? header.frames : 1;
  const std::string rest[] = {
      FormatUtc(begin, "%Y%m%d"),
      FormatUtc(begin, "%H%M%S", 4),
      std::to_string(clock_mode()),
      std::to_string(mode),
      "0",  // length of the probe; it is included in the airtime
      Whole(sound.bandwidth_khz * 1e3),
      Whole(sound.centre_khz * 1e3),
      std::to_string(header.rate),
      std::to_string(header.source),
      std::to_string(header.destination),
      header.acks != 0 ? "1" : "0",
      std::to_string(frames),
      std::to_string(mode == 0 ? frames : 0),
      std::to_string(NumberOf(header.type, header.rate, packet)),
      std::to_string(packet.bytes),
  };
  fields.insert(fields.end(), std::begin(rest), std::end(rest));
  Say(fields);
}

}  // namespace stg::acoustics::micromodem

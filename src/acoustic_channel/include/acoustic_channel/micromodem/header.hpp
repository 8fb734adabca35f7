#pragma once

#include <cstdint>

/// Fields that a Micromodem sends beside the payload, in Transmission::header.
namespace stg::acoustics::micromodem {

enum class PacketType : std::uint8_t {
  kPlain,     ///< of a vehicle without such a modem
  kCycle,     ///< start of a cycle, or a poll that asks another modem to start one
  kData,      ///< frames of a cycle
  kFlexible,  ///< data without a cycle (flexible data protocol)
  kPing,
  kReply,
  kMini,  ///< 13 bits of the host's
  kAck,
  kLbl,  ///< a sound of LBL ranging, with a header of its own (LblSound)
};

struct PacketHeader {
  PacketType type = PacketType::kPlain;
  int source = 0, destination = 0;  ///< addresses, 0 to 127
  int rate = 0;
  int frames = 0;          ///< of kCycle, kData, kFlexible: how many; at most 8
  unsigned acks = 0;       ///< a bit for each frame: asked for, or (kAck) given
  bool text = false;       ///< the host wrote them as text
  int frame_bytes = 0;     ///< of every frame but the last
  bool uneven = false;     ///< their lengths stand behind them, a byte each (0: 256)
  int poller_command = 0;  ///< of kCycle: the unused field of CCCYC, 0 to 15
};

inline std::uint64_t Pack(const PacketHeader& h) {
  const auto put = [](std::uint64_t value, int bits, int at) {
    return (value & ((std::uint64_t{1} << bits) - 1)) << at;
  };
  const auto number = [](int value) { return static_cast<std::uint64_t>(value); };
  return put(static_cast<std::uint64_t>(h.type), 4, 0) | put(number(h.source), 7, 4) |
         put(number(h.destination), 7, 11) | put(number(h.rate), 3, 18) |
         put(number(h.frames), 4, 21) | put(h.acks, 8, 25) | put(h.text ? 1 : 0, 1, 33) |
         put(number(h.frame_bytes), 12, 34) | put(h.uneven ? 1 : 0, 1, 46) |
         put(number(h.poller_command), 4, 47);
}

inline PacketHeader Unpack(std::uint64_t bits) {
  const auto take = [bits](int count, int at) {
    return static_cast<int>(bits >> at & ((std::uint64_t{1} << count) - 1));
  };
  PacketHeader h;
  h.type = static_cast<PacketType>(take(4, 0));
  h.source = take(7, 4);
  h.destination = take(7, 11);
  h.rate = take(3, 18);
  h.frames = take(4, 21);
  h.acks = static_cast<unsigned>(take(8, 25));
  h.text = take(1, 33) != 0;
  h.frame_bytes = take(12, 34);
  h.uneven = take(1, 46) != 0;
  h.poller_command = take(4, 47);
  return h;
}

}  // namespace stg::acoustics::micromodem

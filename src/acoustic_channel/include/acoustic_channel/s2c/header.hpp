#pragma once

#include <cstdint>

/// Fields that an S2C modem sends beside the payload, in Transmission::header.
namespace stg::acoustics::s2c {

enum class MessageType : std::uint8_t {
  kPlain,  ///< of a vehicle without such a modem: an instant message without acknowledgement
  kIm,     ///< instant message
  kIms,    ///< synchronous instant message
  kAck,    ///< acknowledgement; its payload is a piggyback message, or an unused byte
  // Of acoustic connections.
  kConnect,   ///< a modem wants to connect
  kAccept,    ///< the answer to kConnect
  kBurst,     ///< data
  kBurstAck,  ///< the acknowledgement of a burst
  kClose,     ///< the other end closes, too
};

enum class Flag : std::uint8_t { kNoack, kAck, kForce };

struct PacketHeader {
  MessageType type = MessageType::kPlain;
  Flag flag = Flag::kNoack;
  int source = 0, destination = 0;   ///< addresses
  int pid = 0;                       ///< protocol id
  bool piggyback = false;            ///< of kAck
  bool raw = false;                  ///< of kBurst: bytes of data mode
  int number = 0;                    ///< of kBurst and kBurstAck, 1 to 255
  std::uint32_t propagation_us = 0;  ///< of kBurst: as its sender measured it, 23 bits
};

inline std::uint64_t Pack(const PacketHeader& h) {
  return static_cast<std::uint64_t>(h.type) | static_cast<std::uint64_t>(h.flag) << 4 |
         static_cast<std::uint64_t>(h.piggyback ? 1 : 0) << 7 |
         static_cast<std::uint64_t>(h.source & 0xff) << 8 |
         static_cast<std::uint64_t>(h.destination & 0xff) << 16 |
         static_cast<std::uint64_t>(h.pid & 0xff) << 24 |
         static_cast<std::uint64_t>(h.number & 0xff) << 32 |
         static_cast<std::uint64_t>(h.propagation_us & 0x7fffff) << 40 |
         static_cast<std::uint64_t>(h.raw ? 1 : 0) << 63;
}

inline PacketHeader Unpack(std::uint64_t bits) {
  PacketHeader h;
  h.type = static_cast<MessageType>(bits & 0xf);
  h.flag = static_cast<Flag>(bits >> 4 & 0x7);
  h.piggyback = (bits >> 7 & 1) != 0;
  h.source = static_cast<int>(bits >> 8 & 0xff);
  h.destination = static_cast<int>(bits >> 16 & 0xff);
  h.pid = static_cast<int>(bits >> 24 & 0xff);
  h.number = static_cast<int>(bits >> 32 & 0xff);
  h.propagation_us = static_cast<std::uint32_t>(bits >> 40 & 0x7fffff);
  h.raw = (bits >> 63 & 1) != 0;
  return h;
}

}  // namespace stg::acoustics::s2c

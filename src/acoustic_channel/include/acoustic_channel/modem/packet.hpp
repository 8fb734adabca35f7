#pragma once

#include <cstddef>
#include <cstdint>

#include "auv_common/time.hpp"

/// Packets between modems. The channel carries bytes and does not read them.
namespace stg::acoustics {

/// Bytes that the caller owns.
struct ByteView {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};
/// Of an array or vector of bytes that outlives the view.
template <class Bytes>
ByteView ViewOf(const Bytes& bytes) {
  return {bytes.data(), bytes.size()};
}

inline constexpr int kToAll = -1;   ///< destination of a packet for all receivers
inline constexpr int kToNone = -2;  ///< of a packet for a modem outside this water

/// Longest payload of a modem without a profile of its own [bytes]: the largest frame set of the
/// modems in use today (eight frames of 256 bytes).
inline constexpr std::size_t kLargestFrame = 2048;

struct ModemProfile;

/// Kind of a packet. Modems use all kinds except data for themselves: vehicles do not receive them,
/// and links do not count them.
enum class PacketKind : std::uint8_t {
  kData,
  kPing,     ///< of Network::Ping, which answers with kReply
  kReply,    ///< to it
  kAck,      ///< an acknowledgement that a modem sends by itself
  kControl,  ///< other packets of a modem's protocol, such as the start of a cycle
};

/// A packet offered to the sender's modem.
struct Transmission {
  int source = 0;
  int destination = kToAll;  ///< or a node; other nodes do not receive it
  TimeNs stamp = 0;          ///< time of the step it is offered in
  TimeNs generation = 0;     ///< time of the content, not after `stamp`
  std::uint32_t tag = 0;     ///< for the caller; returned in receptions and reports
  ByteView payload;          ///< not empty; the modem copies it

  // For modems with a protocol of their own; only Network reads it.
  PacketKind kind = PacketKind::kData;  ///< kData, kAck or kControl
  const ModemProfile* mode = nullptr;   ///< of the transmission; null: the node's. Outlives the run
  std::size_t air_bytes = 0;  ///< number of bytes that defines the airtime; 0: the payload's
  double level_db = 0.0;      ///< added to the source level of the mode
  std::uint64_t header = 0;   ///< carried along; it has no airtime
};

/// A packet from a receiver's modem. Every number is finite.
///
/// A reception without payload is the answer to a ping, in a channel whose nodes range by
/// themselves: `source` is the answering node, `transmit` the time of the request, `generation` the
/// time of the range, travel_time_s half the round trip.
struct Reception {
  int source = 0, receiver = 0;
  int destination = kToAll;       ///< as addressed by the sender
  std::uint32_t sequence = 0;     ///< of packets that left the source in this episode, from 0
  TimeNs generation = 0;          ///< of the payload
  TimeNs transmit = 0;            ///< the packet began to leave the sender
  TimeNs arrival = 0;             ///< the packet was complete at the receiver
  double distance_m = 0.0;        ///< between the two at transmission
  double travel_time_s = 0.0;     ///< one-way, by the clocks of both modems
  double loss_probability = 0.0;  ///< probability that this packet is lost
  double link_quality = 0.0;      ///< [0, 1], of the model, with the age at arrival
  double received_level_db =
      0.0;                      ///< re 1 uPa; this and the next two are 0 when the model has none
  double noise_level_db = 0.0;  ///< re 1 uPa, in the modem's band
  double sinr_db = 0.0;         ///< signal to interference and noise
  double doppler_mps = 0.0;     ///< closing speed at transmission, positive closing
  bool has_direction = false;   ///< the receiver measured the next two
  double azimuth_rad = 0.0;     ///< of the sender in the receiver's body axes, from ahead to port
  double elevation_rad = 0.0;   ///< likewise, above the body's horizontal plane
  std::uint32_t tag = 0;        ///< Transmission::tag; not on the air
  std::uint64_t header = 0;     ///< Transmission::header
  ByteView payload;             ///< valid until the channel's next Step or Reset; may be empty
};

}  // namespace stg::acoustics

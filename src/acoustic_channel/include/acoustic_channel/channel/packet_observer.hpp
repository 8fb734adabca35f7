#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "acoustic_channel/link/link_statistics.hpp"
#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/time.hpp"

/// Reports of packets, for logs, views and senders. They have no influence on the physics.
namespace stg::acoustics {

inline constexpr std::uint32_t kNoSequence = std::numeric_limits<std::uint32_t>::max();

/// A packet at its sender. Times count from the start of the episode.
struct PacketInfo {
  int source = 0, destination = kToAll;
  PacketKind kind = PacketKind::kData;
  std::uint32_t tag = 0;                 ///< as the caller offered it (Transmission::tag)
  std::uint32_t sequence = kNoSequence;  ///< once it leaves; see Reception::sequence
  std::size_t bytes = 0;
  TimeNs offered = 0, generation = 0;
  TimeNs transmit = 0, transmit_end = 0;  ///< of the sound at the sender; once it leaves
  std::uint64_t header = 0;               ///< Transmission::header
  const ModemProfile* mode = nullptr;     ///< mode of the transmission; null: no model of modems
};

/// The fate of a packet at one of its receivers.
struct PacketFate {
  int receiver = 0;
  DropReason reason = DropReason::kNone;  ///< kNone: delivered
  TimeNs begin = 0, arrival = 0;          ///< of the sound at the receiver; equal without airtime
  double distance_m = 0.0;                ///< at transmission
  double travel_time_s = 0.0;             ///< true
  double received_level_db = 0.0;  ///< re 1 uPa; this and the next two are 0 when a model has none
  double noise_level_db = 0.0;     ///< in the receiver's band, without other packets
  double sinr_db = 0.0;            ///< mean over the packet for delivered and garbled ones; else
                                   ///< at its begin
  double loss_probability = 0.0;   ///< probability of its loss, once it was acquired
};

/// The end of a packet's reception at a modem that locked onto it, for any destination.
struct HeardEnd {
  PacketFate fate;           ///< kHalfDuplex and kLeft: it ended before the last sound
  double closing_mps = 0.0;  ///< at transmission
  ByteView payload;          ///< valid during the call; empty: the modem could not read it
};

/// How a ping ended.
struct PingResult {
  int source = 0, destination = 0;
  std::uint32_t tag = 0;
  bool answered = false;
  bool replaced = false;        ///< ended because its source pinged again
  TimeNs asked = 0, ended = 0;  ///< time of the request; time of the answer or timeout
  TimeNs middle = 0;            ///< middle between the departures of request and reply
  double round_trip_s = 0.0;    ///< by the source's clock, without turnaround and airtimes
  double range_m = 0.0;         ///< from it and the sound speed at the source
  double true_range_m = 0.0;    ///< when the reply left
};

/// Every model of Channel calls it for every packet, in the order in which events are decided, at
/// each node in order of time. It must not call the channel. All functions do nothing by default.
class PacketObserver {
 public:
  virtual ~PacketObserver() = default;
  /// The sender's modem has taken a packet.
  virtual void OnQueued(const PacketInfo&) {}
  /// A packet will never leave: the queue replaced or refused it (kQueue), or its node left
  /// (kLeft).
  virtual void OnDiscarded(const PacketInfo&, DropReason, TimeNs /*t*/) {}
  /// A transmission begins.
  virtual void OnSent(const PacketInfo&) {}
  /// A transmission has ended.
  virtual void OnSendEnd(const PacketInfo&) {}
  /// The receiver locks onto a packet, for any destination; `begin` is the time of its first sound.
  virtual void OnAcquired(const PacketInfo&, int /*receiver*/, TimeNs /*begin*/) {}
  /// The reception ends at t: once for each acquired packet, after its OnFate if there is one.
  virtual void OnReceptionEnd(const PacketInfo&, const HeardEnd&, TimeNs /*t*/) {}
  /// Once for each receiver of a packet; for a delivered packet, when it is complete.
  virtual void OnFate(const PacketInfo&, const PacketFate&) {}
  virtual void OnPing(const PingResult&) {}
};

}  // namespace stg::acoustics

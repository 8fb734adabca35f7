#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "acoustic_channel/link/link_statistics.hpp"
#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/time.hpp"

/// What happens to packets, for logs, views and senders. No part of the physics.
namespace stg::acoustics {

inline constexpr std::uint32_t kNoSequence = std::numeric_limits<std::uint32_t>::max();

/// A packet as its sender knows it. Times count from the start of the episode.
struct PacketInfo {
  int source = 0, destination = kToAll;
  PacketKind kind = PacketKind::kData;
  std::uint32_t tag = 0;                 ///< as the caller offered it (Transmission::tag)
  std::uint32_t sequence = kNoSequence;  ///< once it leaves; see Reception::sequence
  std::size_t bytes = 0;
  TimeNs offered = 0, generation = 0;
  TimeNs transmit = 0, transmit_end = 0;  ///< of the sound at the sender; once it leaves
  std::uint64_t header = 0;               ///< Transmission::header
  const ModemProfile* mode = nullptr;     ///< that it is sent in; null: no model of modems
};

/// What became of a packet at one receiver it was for.
struct PacketFate {
  int receiver = 0;
  DropReason reason = DropReason::kNone;  ///< kNone: delivered
  TimeNs begin = 0, arrival = 0;  ///< of the sound at the receiver; equal where there is no airtime
  double distance_m = 0.0;        ///< at transmission
  double travel_time_s = 0.0;     ///< true
  double received_level_db = 0.0;  ///< re 1 uPa; this and the next two are 0 when a model has none
  double noise_level_db = 0.0;     ///< in the receiver's band, without other packets
  double sinr_db = 0.0;            ///< mean over the packet for delivered and garbled ones; else
                                   ///< at its begin
  double loss_probability = 0.0;   ///< with which it could have been lost, once it was acquired
};

/// What a modem knows of a packet that it locked onto, for any destination, when it lets go of it.
struct HeardEnd {
  PacketFate fate;           ///< kHalfDuplex and kLeft: it let go before the last sound
  double closing_mps = 0.0;  ///< at transmission
  ByteView payload;          ///< of one that it could read, during the call; empty: it could not
};

/// How a ping ended.
struct PingResult {
  int source = 0, destination = 0;
  std::uint32_t tag = 0;
  bool answered = false;
  bool replaced = false;        ///< given up because its source pings anew
  TimeNs asked = 0, ended = 0;  ///< offered; answered or given up
  TimeNs middle = 0;            ///< between when the request left and the reply did
  double round_trip_s = 0.0;    ///< by the source's clock, without turnaround and airtimes
  double range_m = 0.0;         ///< from it and the sound speed at the source
  double true_range_m = 0.0;    ///< when the reply left
};

/// Every model of Channel calls it for every packet. Calls come in the order in which things are
/// decided, at each node in order of time; nothing may be called back. All default to nothing.
class PacketObserver {
 public:
  virtual ~PacketObserver() = default;
  /// Taken by the sender's modem.
  virtual void OnQueued(const PacketInfo&) {}
  /// Will never leave: replaced or refused by the queue (kQueue), its node left (kLeft).
  virtual void OnDiscarded(const PacketInfo&, DropReason, TimeNs /*t*/) {}
  /// Begins to leave.
  virtual void OnSent(const PacketInfo&) {}
  /// Its last sound has left.
  virtual void OnSendEnd(const PacketInfo&) {}
  /// The receiver locks onto a packet, for any destination; `begin` is the time of its first sound.
  virtual void OnAcquired(const PacketInfo&, int /*receiver*/, TimeNs /*begin*/) {}
  /// And lets go of it at t. Of every packet that was acquired, after its OnFate if there is one.
  virtual void OnReceptionEnd(const PacketInfo&, const HeardEnd&, TimeNs /*t*/) {}
  /// Once for each node that it was for. That of a delivered one comes when it is complete.
  virtual void OnFate(const PacketInfo&, const PacketFate&) {}
  virtual void OnPing(const PingResult&) {}
};

}  // namespace stg::acoustics

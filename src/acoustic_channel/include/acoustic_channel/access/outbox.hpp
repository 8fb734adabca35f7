#pragma once

#include <cassert>
#include <cstdint>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/modem/packet.hpp"

namespace stg::acoustics {

/// A packet that leaves its modem.
struct Departure {
  const Transmission& packet;
  std::uint32_t sequence;  ///< of packets that left this source in this episode, from 0
  TimeNs start;            ///< it begins to leave
};

/// The sending side of the modems of an ideal channel. A packet waits in its modem until medium
/// access lets it leave; a newer packet replaces a waiting one, which keeps the age of information
/// low. Allocates only while a modem's waiting payloads reach a new maximum size.
class Outbox {
 public:
  /// Throws UserError for an unknown medium access.
  Outbox(const ChannelConfig& config, const RunConfig& run);

  void Reset(std::uint64_t seed, std::uint32_t episode);

  /// See Turns::Due.
  bool Due(int node, TimeNs t) { return turns_.Due(node, t); }

  /// Drops the waiting packet of a modem, and calls discarded(const Transmission&).
  template <class Discarded>
  void Drop(int node, Discarded&& discarded);

  /// Runs one step of all modems.
  /// @param offered at t, at most one per node, in any order
  /// @param send (const Departure&), for each packet that leaves before the next step
  /// @param replaced (const Transmission&), for each packet that never leaves
  template <class Send, class Replaced>
  void Step(TimeNs t, const std::vector<Transmission>& offered, Send&& send, Replaced&& replaced);

 private:
  struct Waiting {
    Transmission packet;
    std::vector<std::uint8_t> bytes;  ///< its payload
    bool full = false;
  };
  void Keep(const Transmission& packet, Waiting* w);
  Departure Depart(const Transmission& packet, TimeNs start) {
    return {packet, sequence_[static_cast<std::size_t>(packet.source)]++, start};
  }

  Turns turns_;
  std::vector<std::uint32_t> sequence_;  ///< [nodes], of the next packet
  std::vector<Waiting> waiting_;         ///< [nodes]
  int full_ = 0;                         ///< modems in which a packet waits
};

template <class Discarded>
void Outbox::Drop(int node, Discarded&& discarded) {
  Waiting& w = waiting_[static_cast<std::size_t>(node)];
  if (!w.full) return;
  w.full = false;
  --full_;
  discarded(w.packet);
}

template <class Send, class Replaced>
void Outbox::Step(TimeNs t, const std::vector<Transmission>& offered, Send&& send,
                  Replaced&& replaced) {
  for (const Transmission& packet : offered) {
    assert(packet.stamp == t && packet.generation <= t);
    Waiting& w = waiting_[static_cast<std::size_t>(packet.source)];
    if (w.full) {
      replaced(w.packet);
      w.full = false;
      --full_;
    }
    const TimeNs start = turns_.Start(packet.source, t);
    if (start == kNever) {
      Keep(packet, &w);
      ++full_;
    } else {
      send(Depart(packet, start));
    }
  }
  for (std::size_t i = 0; full_ > 0 && i < waiting_.size(); ++i) {
    Waiting& w = waiting_[i];
    // A packet that was offered at t and still waits does not start in this step.
    const TimeNs start = w.full ? turns_.Start(static_cast<int>(i), t) : kNever;
    if (start == kNever) continue;
    send(Depart(w.packet, start));
    w.full = false;
    --full_;
  }
}

}  // namespace stg::acoustics

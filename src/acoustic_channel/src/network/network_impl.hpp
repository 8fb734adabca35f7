#pragma once

#include <cassert>
#include <cmath>
#include <memory>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/modem/payload_pool.hpp"
#include "acoustic_channel/network/event_queue.hpp"
#include "acoustic_channel/network/network.hpp"

namespace stg::acoustics {

/// The state of a network: nodes, packets and arrivals, and the events between them. The parts of
/// the class are in network.cpp (time, motion, energy), sending.cpp and receiving.cpp.
class Network::Impl {
 public:
  static constexpr int kNone = -1;

  struct Packet {
    PacketInfo info;
    int payload = kNone;              ///< index in payloads_
    int holders = 0;                  ///< number of owners: queue or sender, and arrivals
    std::uint32_t draw_sequence = 0;  ///< keys its random numbers
    double bits = 0.0;                ///< bits that are transmitted
    std::uint32_t ping = 0;           ///< number of the request among those of its source
    TimeNs deadline = 0;              ///< for a request
    double level_db = 0.0;            ///< added to the source level
    TimeNs airtime = 0;
  };

  /// A packet at one receiver, from the beginning to the end of its sound.
  struct Arrival {
    int packet = kNone, receiver = 0;
    bool open = true;        ///< its fate is not reported yet
    bool candidate = false;  ///< it has just begun, and the receiver has not decided yet
    Hearing hearing;
    double power = 0.0;  ///< in the receiver's band, 1 uPa^2
    double closing_mps = 0.0;
    TimeNs begin = 0, end = 0;
    // While it is locked: sums up to piece_begin, as shares of the whole packet.
    TimeNs piece_begin = 0;
    double log_success = 0.0;
    double noise = 0.0, interference = 0.0;  ///< mean powers
  };

  struct Ping {
    std::uint32_t number = 0;
    bool open = false;
    PingResult result;
    TimeNs transmit = 0;
    /// Error with which the other modem measured the time of the request.
    double request_error_s = 0.0;
  };

  struct Delivered {
    Reception reception;
    int payload;
  };

  struct Node {
    ModemProfile profile;
    std::vector<std::string> waveforms;  ///< waveforms that it decodes in addition to the profile's
    NodeMotion motion;
    TimeNs moved = 0;  ///< time of motion
    bool present = true;
    double clock_offset_s = 0.0, clock_rate = 0.0;  ///< clock = t + offset + rate t

    // Sending.
    std::vector<int> queue;  ///< packets, oldest first
    int request = kNone;     ///< a waiting ping; it has priority
    std::uint32_t sequence = 0, control_sequence = 0, tries = 0;
    bool attempts = false;  ///< an event kSend is scheduled
    int sending = kNone;
    TimeNs send_begin = 0, send_end = 0, ready = 0, last_end = kNever;
    Ping ping;

    // Receiving.
    std::vector<int> active;  ///< arrivals whose sound is at the node now
    int locked = kNone;
    TimeNs lock_begin = 0;
    double noise = 0.0, quiet_noise = 0.0;  ///< powers, while an arrival is locked
    std::vector<Delivered> delivered;

    // Completed spans.
    TimeNs present_since = 0, present_ns = 0, sent_ns = 0, received_ns = 0;
  };

  struct Move {
    NodeMotion motion;
    bool present = true;
  };

  Impl(const ChannelConfig& config, const RunConfig& run, std::unique_ptr<Medium> medium);

  void Reset(std::uint64_t seed, std::uint32_t episode);
  void Advance(TimeNs t);
  void Happen(const Event& event);

  // network.cpp
  NodeMotion Motion(const Node& n, TimeNs t) const;
  void SetMotion(int node, TimeNs t, const NodeMotion& motion);
  void SetPresent(int node, TimeNs t, bool present);
  double EnergyJ(const Node& n, TimeNs t) const;
  TimeNs Sent(const Node& n, TimeNs t) const {
    return n.sent_ns + (n.sending != kNone ? t - n.send_begin : 0);
  }
  double ClockError(const Node& n, TimeNs t) const {
    return n.clock_offset_s + n.clock_rate * Seconds(t);
  }
  Node& At(int node) { return nodes_[static_cast<std::size_t>(node)]; }
  const Node& At(int node) const { return nodes_[static_cast<std::size_t>(node)]; }

  // sending.cpp
  int MakePacket(const Transmission& offer, PacketKind kind);
  void ReleasePacket(int packet);
  void Queue(int packet, TimeNs t);
  bool Cancel(int node, std::uint32_t tag, TimeNs t);
  void Discard(int packet, DropReason reason, TimeNs t);
  void Attempt(int node, TimeNs t);
  void TrySend(int node, TimeNs t);
  void Send(int node, int packet, TimeNs t);
  void EndSend(int node, TimeNs t);
  void Propagate(int packet, int receiver, TimeNs t, const NodeMotion& source);
  void StartPing(int packet, TimeNs t);
  void EndPing(int node, TimeNs t, bool answered);
  void Answer(const Arrival& request, TimeNs t);
  void Reply(int node, int packet, TimeNs t);
  void TakeReply(const Arrival& reply, TimeNs t);
  /// Adds the error with which a receiver measures a travel time.
  void AddTimingError(const Packet& packet, int receiver, double* travel_time_s) const;

  // receiving.cpp
  void Begin(int arrival, TimeNs t);
  void Acquire(int node, TimeNs t);
  void End(int arrival, TimeNs t);
  void ChangeNoise(int node, int arrival, TimeNs t);
  void Unlock(Node* n, TimeNs t);
  void Integrate(Node* n, TimeNs t);
  void SenseNoise(int node, TimeNs t);
  /// Power of all sounds at a node except one arrival, weighted as the receiver of this arrival
  /// does.
  double Interference(const Node& n, int but) const;
  bool HearsCarrier(int node, TimeNs t);
  void LockOrDrop(int node, int arrival, TimeNs t);
  void Finish(int arrival, TimeNs t);
  void Deliver(const Packet& packet, const Arrival& arrival, double loss, double sinr_db);
  const ModemProfile& SenderOf(const Arrival& a) const { return *packets_[a.packet].info.mode; }
  bool Understands(const Node& n, const ModemProfile& sender) const;
  bool IsFor(const Packet& p, int receiver) const {
    return p.info.destination == receiver || (p.info.destination == kToAll && receiver < talkers_);
  }
  /// Closes an arrival, and reports its fate if it was for this node.
  void Drop(Arrival* a, DropReason reason, double noise_db, double sinr_db, double loss);
  void Tell(const Packet& packet, const PacketFate& fate);
  /// Ends the lock of an arrival before its end.
  void BreakLock(const Arrival& a, DropReason reason, TimeNs t);
  void EndLock(const Arrival& a, const PacketFate& fate, bool read, TimeNs t);
  PacketFate FateOf(const Arrival& a) const;

  int count_, talkers_;  ///< number of nodes, and number of those that are not transponders
  int timekeepers_;      ///< number of the last talkers, whose clocks are right
  std::size_t max_payload_;
  ModemConfig config_;
  std::unique_ptr<Medium> medium_;
  std::unique_ptr<MediumAccess> access_;
  PacketObserver* observer_ = nullptr;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  TimeNs now_ = -1;
  EventQueue events_;
  std::vector<Node> nodes_;
  Pool<Packet> packets_;
  Pool<Arrival> arrivals_;
  Pool<Move> moves_;
  PayloadPool payloads_;
  LinkTable table_;
};

/// 10 lg of a ratio of powers.
inline double Db(double ratio) { return 10.0 * std::log10(ratio); }
inline double FromDb(double db) { return std::exp(db * 0.23025850929940457); }

}  // namespace stg::acoustics

#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/channel/packet_observer.hpp"
#include "acoustic_channel/channel_config.hpp"
#include "acoustic_channel/link/link_statistics.hpp"
#include "acoustic_channel/modem/packet.hpp"
#include "acoustic_channel/network/medium.hpp"
#include "acoustic_channel/propagation/propagation.hpp"
#include "auv_common/config/run_config.hpp"

namespace stg::acoustics {

/// Modems and the water between them in continuous time, as a queue of events. Times count from the
/// start of the episode [ns]. Only one thread at a time may call it.
///
/// A call for time t takes effect at t, in Advance. At the same time, positions come before
/// packets, packets before starts of transmissions, and ends of receptions before begins; then
/// source and receiver define the order. The order of calls has no influence.
///
/// After its last Move a node continues in a straight line at its last velocity. A caller that gets
/// no more positions of a vehicle may call Move with velocity zero instead.
///
/// Allocates only when the number of packets under way exceeds its earlier maximum.
class Network {
 public:
  /// Throws UserError for a name in the section that does not exist.
  /// @param run its number of agents is the number of nodes, of which the last `transponders` get
  /// no packets for all and have no turn of medium access; only `periodic` uses the clock
  Network(const ChannelConfig& config, const RunConfig& run, std::unique_ptr<Medium> medium);
  /// The same, with the water that the section describes.
  /// @param line_of_sight empty: all lines are free
  Network(const ChannelConfig& config, const RunConfig& run, LineOfSight line_of_sight = {});
  ~Network();

  /// Starts an episode at time 0: all nodes present, at the origin and silent.
  void Reset(std::uint64_t seed, std::uint32_t episode);
  /// Null: no reports. It must live as long as the network or the next call.
  void Observe(PacketObserver* observer);

  int nodes() const;
  /// All events up to and including this time have happened. It is below 0 until the first Run, so
  /// that events at 0 are not in the past.
  TimeNs now() const;
  std::size_t max_payload() const;
  const ModemProfile& profile(int node) const;
  const ChannelTotals& totals() const;
  const LinkTable& table() const;
  /// Counts of packets and ages of links begin at this time instead of at 0.
  void StartStatistics(TimeNs t);

  // Times must be now() or later. Earlier times, and values that are not finite, throw
  // std::invalid_argument.
  void Move(int node, TimeNs t, const Vec3<double>& p_W, const Vec3<double>& v_W);
  /// Offers a packet at its stamp. It must satisfy Channel::CheckOrThrow.
  void Offer(const Transmission& packet);
  /// Discards (kQueue) a packet that still waits in the modem of `source`. False: no packet with
  /// this tag waits there.
  bool Cancel(int source, std::uint32_t tag);
  /// More waveforms in its band that a node can decode, in addition to its profile's.
  void SetWaveforms(int node, std::vector<std::string> waveforms);
  /// An absent node neither sends nor receives. Packets that wait in its modem and packets that it
  /// was receiving are lost. Sound that is already in the water continues.
  void SetPresent(int node, TimeNs t, bool present);
  /// Measures the range to a node: request, turnaround, reply. The observer gets the result. A
  /// source has one ping at a time: a new ping before the answer or the timeout replaces it.
  void Ping(int source, int destination, TimeNs t, TimeNs timeout, std::uint32_t tag);

  /// Time of the next event; kNever: there is none.
  TimeNs next() const;
  /// Processes all events up to and including t.
  void Advance(TimeNs t);

  /// Appends the new receptions of node `receiver` up to `until`, oldest first. A payload is valid
  /// until the next Recycle. A caller that needs no receptions calls Forget instead.
  void Take(int receiver, TimeNs until, std::vector<Reception>* out);
  void Forget();
  /// Releases the payloads that Take returned.
  void Recycle();

  NodeMotion Motion(int node, TimeNs t) const;
  bool present(int node) const;
  /// Electric energy that a modem has used by t >= now() [J]: transmitting, receiving, idle.
  double EnergyJ(int node, TimeNs t) const;
  /// Time for which a modem has sent by t >= now() [s].
  double SentS(int node, TimeNs t) const;
  /// Time on a node's clock at true time t [s].
  double ClockS(int node, TimeNs t) const;
  /// Expected values of a link at time t.
  Hearing Expect(int source, int destination, TimeNs t) const;
  /// At a node now [m/s].
  double SoundSpeed(int node) const;
  /// Probability that a packet of the longest payload is lost to noise alone, without any draw.
  double ExpectedLoss(int source, int destination, TimeNs t) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stg::acoustics

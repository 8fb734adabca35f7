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
/// start of the episode [ns]. No thread may call it while another does.
///
/// What a call says of time t takes effect at t, and in Advance. Within one time, positions come
/// before packets, packets before starts of transmissions, ends of receptions before begins; then
/// the source and the receiver decide: the order of calls does not.
///
/// A node moves on a straight line at its last velocity from its last Move; a caller that no longer
/// hears from a vehicle and does not believe that moves it with velocity zero.
///
/// Allocates only while more is under way than ever before.
class Network {
 public:
  /// Throws UserError for a name in the section that does not exist.
  /// @param run its number of agents is that of the nodes; the clock matters to `periodic` only
  Network(const ChannelConfig& config, const RunConfig& run, std::unique_ptr<Medium> medium);
  /// With the water that the section describes.
  /// @param line_of_sight empty: all lines are free
  Network(const ChannelConfig& config, const RunConfig& run, LineOfSight line_of_sight = {});
  ~Network();

  /// Starts an episode at time 0: all nodes present, at the origin and silent.
  void Reset(std::uint64_t seed, std::uint32_t episode);
  /// Null: no reports. It must live as long as the network or the next call.
  void Observe(PacketObserver* observer);

  int nodes() const;
  /// Everything up to and including this time has happened. Starts before 0.
  TimeNs now() const;
  std::size_t max_payload() const;
  const ModemProfile& profile(int node) const;
  const ChannelTotals& totals() const;
  const LinkTable& table() const;
  /// Counts and ages begin here instead of at 0.
  void StartStatistics(TimeNs t);

  // At any time from now() on. Earlier: std::invalid_argument, also for what is not finite.
  void Move(int node, TimeNs t, const Vec3<double>& p_W, const Vec3<double>& v_W);
  /// As Channel::CheckOrThrow wants it; at its stamp.
  void Offer(const Transmission& packet);
  /// Takes a packet back that still waits in the modem of `source`: it is discarded (kQueue) now.
  /// False: there is none with this tag.
  bool Cancel(int source, std::uint32_t tag);
  /// Waveforms that a node's front end decodes besides that of its profile, in its band.
  void SetWaveforms(int node, std::vector<std::string> waveforms);
  /// An absent node neither sends nor hears; what waits in its modem and what it was receiving is
  /// lost. Sound that is in the water goes on.
  void SetPresent(int node, TimeNs t, bool present);
  /// Asks a node how far away it is: request, turnaround, reply. The answer goes to the observer.
  /// One at a time of a source: another one before the answer or the end of `timeout` replaces it.
  void Ping(int source, int destination, TimeNs t, TimeNs timeout, std::uint32_t tag);

  /// When something will happen next; kNever: nothing is under way.
  TimeNs next() const;
  /// Lets everything up to and including t happen.
  void Advance(TimeNs t);

  /// Appends what node `receiver` received by `until` and was not given before, oldest first. A
  /// payload is valid until the next Recycle. A caller without receptions calls Forget instead.
  void Take(int receiver, TimeNs until, std::vector<Reception>* out);
  void Forget();
  /// Payloads handed out by Take are given back.
  void Recycle();

  NodeMotion Motion(int node, TimeNs t) const;
  bool present(int node) const;
  bool transmitting(int node) const;
  /// Electric energy that a modem has used by t >= now() [J]: transmitting, receiving, idle.
  double EnergyJ(int node, TimeNs t) const;
  /// What a node's clock shows at true time t [s].
  double ClockS(int node, TimeNs t) const;
  /// What to expect of a link now.
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

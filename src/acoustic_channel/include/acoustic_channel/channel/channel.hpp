#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "acoustic_channel/channel/packet_observer.hpp"
#include "acoustic_channel/channel_config.hpp"
#include "acoustic_channel/link/link_statistics.hpp"
#include "acoustic_channel/modem/packet.hpp"
#include "acoustic_channel/propagation/propagation.hpp"
#include "auv_common/config/run_config.hpp"
#include "auv_common/numbers/vector.hpp"

/// The acoustic channel: takes packets and true positions, delivers or drops.
namespace stg::acoustics {

/// Carries packets between nodes: their modems and the water between them. One object per
/// environment; not thread-safe.
///
/// Use, for every decision step k at t_k: Step(t_k, ...), then Deliver(i, t_{k+1}) for every
/// node i before Step(t_{k+1}, ...). The fate of a packet at one receiver may be undecided until
/// the Deliver call that covers its arrival: a model with interference decides there, when all
/// packets that could interfere are known. Statistics therefore count deliveries when Deliver
/// returns them, with their time of arrival.
class Channel {
 public:
  virtual ~Channel() = default;

  /// Starts an episode: no packet waits or is under way, and the statistics are empty. The first
  /// Step starts the clock of the statistics.
  virtual void Reset(std::uint64_t seed, std::uint32_t episode) = 0;

  /// Sends reports of all packets from now on to the observer. Null: no reports, at no cost.
  virtual void Observe(PacketObserver* observer) = 0;
  /// Takes effect at the next Step. An absent node neither sends nor receives. After Reset all
  /// nodes are present.
  virtual void SetPresent(int node, bool present) = 0;
  /// True: Step takes any number of packets per node, with stamps after the last time of Deliver
  /// and up to t. False: at most one packet per node, with stamp t.
  virtual bool continuous() const { return false; }

  virtual int nodes() const = 0;
  /// Number of positions and velocities that Step takes: the nodes, and then the bodies that answer
  /// the nodes' pings.
  virtual int bodies() const { return nodes(); }
  /// Longest payload of a packet [bytes].
  virtual std::size_t max_payload() const = 0;

  /// False: the packet of the next step would replace a packet that `node` offers at step t, so it
  /// need not be made.
  virtual bool Due(int node, TimeNs t) = 0;

  /// Closes decision step `step` at time t: true positions [m] and velocities [m/s] at t, world
  /// axes, and the packets offered at t in any order, at most one per node. They leave when medium
  /// access lets them. Packets must satisfy CheckOrThrow; non-finite positions or velocities throw
  /// std::invalid_argument.
  virtual void Step(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
                    const std::vector<Vec3<double>>& v_W,
                    const std::vector<Transmission>& offered) = 0;

  /// True: nodes measure the direction of each reception, for which the channel needs SetAttitudes.
  virtual bool measures_directions() const { return false; }
  /// True attitudes of the nodes, before each Step. Directions are in body axes of the newest ones.
  virtual void SetAttitudes(const std::vector<Mat3<double>>& /*R_WB*/) {}

  /// Appends all receptions of node `receiver` with arrival <= until to *out, oldest first (ties
  /// by source), each one once. No allocation in steady state.
  virtual void Deliver(int receiver, TimeNs until, std::vector<Reception>* out) = 0;

  /// The directed link source -> destination at time `now`, which is not before the last Step.
  virtual LinkStatistics Link(int source, int destination, TimeNs now) const = 0;

  /// Packets of this episode, all links together.
  virtual const ChannelTotals& totals() const = 0;

  /// Two-way ranging from the next Step on, at time t; see Network::Ping. Throws UserError when the
  /// model has none or a node does not exist.
  virtual void Ping(int source, int destination, TimeNs t, TimeNs timeout, std::uint32_t tag);
  /// Electric energy that a node's modem has used [J]; 0 of models that do not count it.
  virtual double EnergyJ(int /*node*/, TimeNs /*now*/) const { return 0.0; }
  /// Time for which it has sent [s], likewise.
  virtual double SentS(int /*node*/, TimeNs /*now*/) const { return 0.0; }
  /// Pings by which nodes range by themselves, of this episode.
  virtual PingTotals pings() const { return {}; }

  /// For packets from outside: throws UserError when the source or the destination does not exist,
  /// the payload is empty or longer than max_payload(), or the packet was generated after it was
  /// offered.
  void CheckOrThrow(const Transmission& packet) const;
};

/// The channel that the section names, between the nodes of the run. Throws UserError for a
/// propagation model or medium access that does not exist.
/// @param line_of_sight for models with shadows; empty: all lines are free
std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, const RunConfig& run,
                                     LineOfSight line_of_sight = {});

}  // namespace stg::acoustics

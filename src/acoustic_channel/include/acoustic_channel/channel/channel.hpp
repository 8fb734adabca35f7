#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "acoustic_channel/channel/channel_config.hpp"
#include "acoustic_channel/link/link_statistics.hpp"
#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

/// The acoustic channel: takes packets and true positions, delivers or drops.
namespace stg::acoustics {

using Payload = std::array<std::uint8_t, 32>;

/// A packet handed to the sender's modem, for all other AUVs.
struct Transmission {
  int source = 0;
  std::uint32_t sequence = 0;  ///< counted per sender from the start of the episode
  TimeNs stamp = 0;            ///< time of the step it is handed over in
  Payload data{};
  TimeNs generation = 0;  ///< time at which the payload was true, not after `stamp`
};

/// A packet as one receiver's modem gives it. Every number is finite.
struct Reception {
  int source = 0, destination = 0;
  std::uint32_t sequence = 0;
  TimeNs generation = 0;           ///< of the payload
  TimeNs transmit = 0;             ///< the packet began to leave the sender
  TimeNs arrival = 0;              ///< the packet was complete at the receiver
  double distance_m = 0.0;         ///< between the two at transmission
  double travel_time_s = 0.0;      ///< one-way travel time of sound
  double loss_probability = 0.0;   ///< probability with which this packet could have been lost
  double link_quality = 0.0;       ///< [0, 1], Eq. 5, or Eq. 6 with the age at arrival
  double received_level_db = 0.0;  ///< re 1 uPa; this and below are 0 when the model has none
  double noise_level_db = 0.0;     ///< re 1 uPa, in the modem's band
  double sinr_db = 0.0;            ///< signal to interference and noise
  double doppler_mps = 0.0;        ///< closing speed, positive closing
  Payload data{};
};

/// Carries packets between AUVs. One object per environment; not thread-safe.
///
/// Use, for every decision step k at t_k: Step(t_k, ...), then Deliver(i, t_{k+1}) for every
/// AUV i before Step(t_{k+1}, ...). A packet's fate towards one receiver is open until the
/// Deliver call that covers its arrival (or never comes): a model with medium access decides
/// there, when all packets that could interfere are known. Statistics therefore count
/// deliveries when Deliver hands them out, with their time of arrival.
class Channel {
 public:
  virtual ~Channel() = default;

  /// Starts an episode: nothing in flight, statistics empty. The first Step starts its clock.
  virtual void Reset(std::uint64_t seed, std::uint32_t episode) = 0;

  /// Closes decision step `step` at time t: true positions at t, and all packets sent at t in
  /// any order, at most one per AUV. Non-finite positions throw std::invalid_argument.
  virtual void Step(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
                    const std::vector<Transmission>& sent) = 0;

  /// Appends all receptions of `destination` with arrival <= until to *out, oldest first (ties
  /// by source), each one once. No allocation in steady state.
  virtual void Deliver(int destination, TimeNs until, std::vector<Reception>* out) = 0;

  /// The directed link source -> destination at time `now`, which is not before the last Step.
  virtual LinkStatistics Link(int source, int destination, TimeNs now) const = 0;

  /// Packets of this episode, all links together.
  virtual const ChannelTotals& totals() const = 0;
};

/// The channel that the section names, between `nodes` vehicles. Throws UserError for a model that
/// is not available.
std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, int nodes);

}  // namespace stg::acoustics

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "auv_common/time.hpp"

/// Delivery counts, delay and age of information of every ordered pair of AUVs.
namespace stg::acoustics {

/// Why a packet did not reach one receiver. kNone: nothing was dropped.
enum class DropReason : std::uint8_t {
  kNone,
  kRange,        ///< receiver beyond the range of the model
  kLoss,         ///< lost by the packet loss probability; `physical`: in noise
  kCollision,    ///< overlapped with another packet at the receiver
  kHalfDuplex,   ///< receiver was transmitting
  kFading,       ///< link in a deep fade
  kBurst,        ///< burst of noise
  kQueue,        ///< discarded before transmission
  kNotAcquired,  ///< too weak for the receiver to lock onto it
  kShadow,       ///< the straight line between the two is not free
  kLeft,         ///< sender or receiver left the network
};
inline constexpr int kDropReasons = 11;
const char* ToString(DropReason reason);

using DropCounts = std::array<std::uint64_t, kDropReasons>;  ///< indexed by DropReason

/// State of one directed link and its statistics over the episode. Every number is finite.
///
/// Age of information is now minus the generation time of the freshest packet delivered so far.
/// Before the first delivery it counts from the start of the episode, as if an update had
/// arrived then: a dead link has a growing age instead of none. Only a packet generated later
/// than all before it resets the age; late and repeated ones count as delivered and change
/// nothing else.
struct LinkStatistics {
  double distance_m = 0.0;        ///< at the last step
  double quality = 0.0;           ///< [0, 1], Eq. 5 or 6 at that distance and the present age
  double loss_probability = 0.0;  ///< at that distance
  double delay_s = 0.0;           ///< propagation delay at that distance
  double mean_delay_s = 0.0;      ///< transmission to arrival, mean of delivered packets
  double age_s = 0.0;             ///< now
  double average_age_s = 0.0;     ///< (1/T) integral of age over the episode, exact
  double peak_age_s = 0.0;        ///< mean age just before it was reset; 0 while it never was
  double max_age_s = 0.0;         ///< largest age so far
  std::uint64_t delivered = 0;    ///< packets that the receiver got
  std::uint64_t dropped = 0;
  DropReason last_drop = DropReason::kNone;
  DropCounts drops{};  ///< by reason
};

/// Packets of the whole swarm; one packet counts once per receiver.
struct ChannelTotals {
  std::uint64_t delivered = 0;
  std::uint64_t dropped = 0;
  DropCounts drops{};  ///< by reason
};

/// Pings of nodes that range by themselves.
struct PingTotals {
  std::uint64_t sent = 0;      ///< requests that left
  std::uint64_t answered = 0;  ///< requests whose answer arrived
};

/// Counts the events of all links; it has no cost between events.
class LinkTable {
 public:
  explicit LinkTable(int agents);

  /// Clears everything; ages count from `start`.
  void Reset(TimeNs start);

  void Drop(int source, int destination, DropReason reason);
  /// Events of one link come in order of arrival.
  void Deliver(int source, int destination, TimeNs generation, TimeNs transmit, TimeNs arrival);

  /// Counts, delay and ages at `now`, not before the link's last event; the fields of the
  /// present geometry stay 0.
  LinkStatistics At(int source, int destination, TimeNs now) const;
  const ChannelTotals& totals() const { return totals_; }
  TimeNs start() const { return start_; }

 private:
  struct Entry {
    TimeNs freshest;     ///< generation time the age counts from
    TimeNs last_event;   ///< the integral covers the time up to here
    double integral_s2;  ///< of age over time
    double delay_sum_s;
    double peak_sum_s;
    double max_peak_s;
    std::uint64_t resets;  ///< deliveries that reset the age
    std::uint64_t delivered;
    DropReason last_drop;
  };
  std::size_t Index(int source, int destination) const {
    return static_cast<std::size_t>(source * agents_ + destination);
  }

  int agents_;
  TimeNs start_ = 0;
  ChannelTotals totals_;
  std::vector<Entry> entries_;
  std::vector<DropCounts> drops_;
};

}  // namespace stg::acoustics

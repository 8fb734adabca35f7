#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/time.hpp"

/// Traffic of a network that is simulated offline.
namespace stg::acoustics {

/// One flow of packets.
struct TrafficSpec {
  enum class Kind {
    kPoisson,   ///< independent packets, `rate_hz` on average
    kPeriodic,  ///< at offset_s + k period_s
    kAt         ///< at times_s
  };
  int source = 0, destination = kToAll;  ///< indices of nodes
  Kind kind = Kind::kPoisson;
  double rate_hz = 0.0;
  double period_s = 0.0, offset_s = 0.0;
  std::vector<double> times_s;  ///< ascending
  std::size_t bytes = 0;
};

/// A packet that is about to be offered.
struct Offer {
  TimeNs t = 0;
  int source = 0, destination = kToAll;
  std::size_t bytes = 0;
};

/// All flows together, in order of time. A flow depends only on the seed and its place in the list.
class Traffic {
 public:
  Traffic(std::vector<TrafficSpec> flows, std::uint64_t seed);

  /// Appends the new packets up to and including t, by time, then by flow.
  void Take(TimeNs t, std::vector<Offer>* offers);

 private:
  struct Flow {
    TrafficSpec spec;
    std::uint32_t next_index = 0;
    TimeNs next = 0;
    bool over = false;
  };
  void Schedule(std::size_t flow);

  std::uint64_t seed_;
  std::vector<Flow> flows_;
  std::vector<std::size_t> heap_;  ///< of flows that continue, the earliest on top
};

}  // namespace stg::acoustics

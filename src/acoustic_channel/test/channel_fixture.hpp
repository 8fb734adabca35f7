#pragma once

#include <cstdint>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"

namespace stg::acoustics {

inline constexpr TimeNs kDt = 100'000'000;  ///< decision period of the default clock

/// A network without losses. A packet leaves as soon as it is offered.
inline NetworkConfig LosslessNetwork(int nodes) {
  NetworkConfig s;
  s.run.agents = nodes;
  s.channel.model = "extended";
  s.channel.periodic.transmit_period_s = 0.1;
  s.channel.extended.max_range_m = 3.5;
  s.channel.extended.loss_probability = 0.0;
  s.channel.extended.loss_distance_m = 1e12;
  return s;
}

inline constexpr std::uint8_t kAnyBytes[] = {17, 0, 255, 4};

/// A packet for all nodes. It holds the state at the time at which it is offered.
inline Transmission From(int source, TimeNs t) {
  Transmission packet;
  packet.source = source;
  packet.stamp = packet.generation = t;
  packet.payload = {kAnyBytes, sizeof(kAnyBytes)};
  return packet;
}

/// A step in which no node moves.
inline void StepAtRest(Channel* channel, TimeNs t, std::uint32_t step,
                       const std::vector<Vec3<double>>& p,
                       const std::vector<Transmission>& offered) {
  channel->Step(t, step, p, std::vector<Vec3<double>>(p.size()), offered);
}

inline std::vector<Reception> DeliverAll(Channel* channel, TimeNs until) {
  std::vector<Reception> out;
  for (int j = 0; j < channel->nodes(); ++j) channel->Deliver(j, until, &out);
  return out;
}

}  // namespace stg::acoustics

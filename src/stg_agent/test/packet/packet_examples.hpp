/// What the tests of packets share.
#pragma once

#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

inline constexpr TimeNs kMs = 1'000'000, kSecond = 1'000'000'000;

inline AgentModel TestScenario() {
  AgentModel s;
  s.run.agents = 7;
  s.target.count = 3;
  return s;
}

/// A state whose numbers are well inside every range.
inline agent::NeighbourState Example() {
  agent::NeighbourState s;
  s.source = 5;
  s.generation = 0x1234 * kMs;
  s.p_W = {0.5, -0.25, 0.125};
  s.v_W = {1.0, -0.5, 0.25};
  s.confidence = 0.6;
  s.tracking_error = 0.2;
  s.phase = 2;
  s.link_quality = 0.4;
  s.has_target = true;
  s.target = 2;
  s.target_stamp = s.generation - 700 * kMs;
  s.p_WT = {-0.3, 0.9, -1.0};
  s.v_WT = {0.01, -0.02, 0.03};
  s.target_std = 0.004;
  return s;
}

/// The definition of the checksum: CRC-8 bit by bit, reflected polynomial 0x1D, initial value 0xFF.
inline void Seal(agent::Packet* packet) {
  unsigned crc = 0xFF;
  for (std::size_t i = 0; i + 1 < packet->size(); ++i) {
    crc ^= (*packet)[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) ? (crc >> 1) ^ 0xB8u : crc >> 1;
  }
  packet->back() = static_cast<std::uint8_t>(crc);
}

}  // namespace stg::agent

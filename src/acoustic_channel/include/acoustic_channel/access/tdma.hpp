#pragma once

#include <memory>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/access/slots_config.hpp"

namespace stg::acoustics {

/// Time division: node i has the slots [(r N + i) L, (r N + i + 1) L) of N nodes, and begins to
/// send at their start. Nothing collides while the guard at the end of a slot covers the way to the
/// farthest node.
class Tdma : public MediumAccess {
 public:
  Tdma(const SlotsConfig& config, int nodes);
  TimeNs Next(int node, TimeNs from, const Attempt& attempt) const override;
  /// Refuses a slot that is shorter than the longest packet and the guard.
  std::optional<config::Violation> FindConflict(const PacketTime& packet) const override;

 private:
  SlotsConfig config_;
  TimeNs slot_, frame_;
};

/// Why a slot cannot hold a packet of this airtime; empty: it can.
std::optional<config::Violation> FindSlotConflict(const SlotsConfig& config, TimeNs airtime);

std::unique_ptr<MediumAccess> MakeTdma(const ChannelConfig& config, const RunConfig& run);

}  // namespace stg::acoustics

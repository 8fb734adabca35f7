#pragma once

#include <memory>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/access/periodic_config.hpp"

namespace stg::acoustics {

/// Staggered slots at decisions: node i sends at decisions k with k mod P = i mod P, where P is the
/// transmit period in decisions, rounded, at least 1. k follows from the time, so a node that joins
/// during an episode has its usual slots. A busy modem skips its slot.
class Periodic : public MediumAccess {
 public:
  Periodic(const PeriodicConfig& config, const RunConfig& run);
  TimeNs Next(int node, TimeNs from, const Attempt& attempt) const override;
  /// Refuses a period that is shorter than a decision.
  std::optional<config::Violation> FindConflict(const PacketTime& packet) const override;

 private:
  double transmit_period_s_, decision_s_;
  TimeNs period_;  ///< of decisions
  TimeNs slots_;   ///< decisions per transmit period, P
};

std::unique_ptr<MediumAccess> MakePeriodic(const ChannelConfig& config, const RunConfig& run);

}  // namespace stg::acoustics

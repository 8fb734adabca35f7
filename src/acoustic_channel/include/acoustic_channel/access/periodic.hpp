#pragma once

#include <memory>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/access/periodic_config.hpp"

namespace stg::acoustics {

/// Staggered slots on an ideal channel: node i sends at decisions k with k mod P = i mod P, where P
/// is the transmit period in decisions, rounded, at least 1. k comes from the time, not from
/// counting: a node that joins in the middle of an episode keeps to its slot.
class Periodic : public MediumAccess {
 public:
  Periodic(const PeriodicConfig& config, const RunConfig& run);
  void Plan(TimeNs from, TimeNs until, std::vector<TimeNs>* start) const override;
  /// A period shorter than a decision cannot be kept.
  std::optional<config::Violation> FindConflict() const override;

 private:
  double transmit_period_s_, decision_s_;
  TimeNs period_;  ///< of decisions
  TimeNs slots_;   ///< decisions per transmit period, P
};

std::unique_ptr<MediumAccess> MakePeriodic(const ChannelConfig& config, const RunConfig& run);

}  // namespace stg::acoustics

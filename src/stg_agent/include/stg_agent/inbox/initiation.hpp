#pragma once

#include "auv_common/numbers/short_list.hpp"
#include "stg_agent/inbox/one_target.hpp"

namespace stg::agent {

/// Decides when unlabelled detections that fit no estimate are a target without an estimate: when
/// M of N looks have one that the same target may cause (M of N logic; Bar-Shalom and Li 1995).
/// A false alarm seldom fits the one before it, because a target is slow. Bearings alone
/// start nothing.
class Initiation {
 public:
  static constexpr int kNeeded = 4;  ///< M
  static constexpr int kLooks = 6;   ///< N
  using Chain = ShortList<dynamics::Detection, kNeeded>;

  explicit Initiation(const AgentModel& model);

  void Clear() { chain_.clear(); }
  /// Takes the detections of one look that have no target, with stamps that rise from look to look.
  /// Returns true if the chain is complete; Clear then starts a new one.
  bool Look(const dynamics::Detection* detections, int count);
  /// Detections that one target may have caused, oldest first.
  const Chain& chain() const { return chain_; }

 private:
  bool MayStart(const dynamics::Detection& d) const;

  OneTarget pair_;
  TimeNs longest_;  // between the first and the last look
  Chain chain_;
};

}  // namespace stg::agent

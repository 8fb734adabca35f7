#pragma once

#include "auv_common/numbers/short_list.hpp"
#include "stg_agent/inbox/one_target.hpp"

namespace stg::agent {

/// Decides if an AUV's own detection of a target may be used, where sensors have false alarms.
///
/// A target in range is detected in most looks, and a false alarm stands alone. The filter of the
/// target cannot tell them apart, because it does not know of looks that detected nothing. So a
/// detection is used only if M of the N looks before it have one that the same target may have
/// caused (M of N logic; Bar-Shalom and Li 1995). Bearings are always used, because two bearings do
/// not show if one target caused both. Without false alarms every detection is used.
class Confirmation {
 public:
  static constexpr int kNeeded = 3;  ///< M
  static constexpr int kLooks = 5;   ///< N

  explicit Confirmation(const AgentModel& model);

  void Clear() { recent_.clear(); }
  /// Takes a detection, with stamps that rise. Returns true if it may be used.
  bool Take(const dynamics::Detection& detection);

 private:
  bool needed_;
  TimeNs longest_;  // from the first of the N looks to the present one
  OneTarget pair_;
  ShortList<dynamics::Detection, kLooks> recent_;  // newest first
};

}  // namespace stg::agent

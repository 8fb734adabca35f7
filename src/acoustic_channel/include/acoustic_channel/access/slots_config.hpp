#pragma once

#include "auv_common/config/field.hpp"

namespace stg::acoustics {

/// Keys of `channel.slots`, which the medium accesses `tdma` and `slotted_aloha` read.
struct SlotsConfig {
  double length_s = 1.5;
  double guard_s = 0.6;           ///< of a slot, for the way to the farthest node
  double send_probability = 1.0;  ///< slotted_aloha: chance to send in a slot
};
/// Adds the keys of both rules, and the keys that only slotted_aloha has.
void Describe(SlotsConfig* c, config::Table* t);
void DescribeDraw(SlotsConfig* c, config::Table* t);

}  // namespace stg::acoustics

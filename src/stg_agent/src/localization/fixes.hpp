#pragma once

#include <cstddef>
#include <vector>

#include "stg_agent/localization/joint_filter.hpp"
#include "stg_agent/localization/localizer.hpp"
#include "stg_agent/localization/own_way.hpp"
#include "stg_agent/packet/neighbour_state.hpp"

namespace stg::agent {

/// GPS fixes: the newest own one, and the newest one of each AUV that is in the filter. An AUV has
/// one fix for each time at the surface, so a fix that is not newer than the newest of its AUV is a
/// copy.
class Fixes {
 public:
  /// @param telling how long packets contain an own fix
  /// @param apart stamps of the same fix differ by less than this, because ages in packets are
  /// rounded
  Fixes(int auvs, int self, TimeNs telling, TimeNs apart)
      : self_(self),
        telling_(telling),
        apart_(apart),
        newest_(static_cast<std::size_t>(auvs), kNever) {}

  void Clear() {
    newest_.assign(newest_.size(), kNever);
    count_ = 0;
    own_ = SentFix();
  }

  /// The own newest fix as a reading. Returns false if it was used already, or if there is none.
  bool TakeOwn(TimeNs now, const OwnReckoning& own, const OwnWay& way, FixReading* z) {
    if (own.fix_std_m <= 0.0 || own.fix_stamp > now || own.fix_stamp <= newest(self_)) return false;
    Vec3<double> p;
    if (!way.At(own.fix_stamp, &p)) return false;
    own_ = {own.fix_stamp, p.x - own.p_WF.x, p.y - own.p_WF.y, own.fix_std_m};
    ++count_;
    return TakeSent(self_, own_, z);
  }

  /// The fix in a packet as a reading. Returns false if it was used already.
  bool TakeSent(int id, const SentFix& sent, FixReading* z) {
    if (newest(id) != kNever && sent.stamp < newest(id) + apart_) return false;
    newest_[static_cast<std::size_t>(id)] = sent.stamp;
    *z = {id, sent.stamp, sent.error_x, sent.error_y, sent.std_m};
    return true;
  }

  /// Adds the own fix to a packet while it is new. Returns false if there is none.
  bool Tell(NeighbourState* packet) const {
    if (count_ == 0 || packet->generation - own_.stamp >= telling_) return false;
    packet->has_fix = true;
    packet->fix = own_;
    return true;
  }

  int count() const { return count_; }  ///< number of own fixes
  /// Time of the newest fix of an AUV; -1: unknown.
  TimeNs newest(int id) const {
    const auto u = static_cast<std::size_t>(id);
    return u < newest_.size() ? newest_[u] : kNever;  // stations have none
  }

 private:
  static constexpr TimeNs kNever = -1;

  int self_;
  TimeNs telling_, apart_;
  std::vector<TimeNs> newest_;  // [auvs]
  int count_ = 0;
  SentFix own_;
};

}  // namespace stg::agent

#pragma once

#include "auv_common/numbers/vector.hpp"

namespace stg::agent {

/// One AUV relative to its target (Eqs. 1, 12-14), estimated or true. Lengths [m], world axes. T =
/// double: one AUV. T = Pack: the same AUV of kLanes environments.
template <class T>
struct Tracking {
  Vec3<T> r_BT_W;                ///< target minus own position: r of Eq. 11
  T distance = T(0.0);           ///< d
  T previous_distance = T(0.0);  ///< d of the previous decision; at the start of an episode, d
  T error = T(0.0);              ///< e = |d - d*|
  T closing = T(0.0);            ///< closing speed [m/s], positive when approaching
  T confidence = T(0.0);         ///< c
  T lost = T(0.0);               ///< l, 0 or 1

  /// Sets offset, distance, error and closing speed. The caller sets the rest, because it knows
  /// when an episode starts and when the target is lost.
  /// @param v_TB_W velocity of the AUV relative to the target [m/s]
  /// @param desired_distance_m d*
  void Measure(const Vec3<T>& offset_W, const Vec3<T>& v_TB_W, double desired_distance_m) {
    r_BT_W = offset_W;
    distance = Norm(r_BT_W);
    error = Abs(distance - T(desired_distance_m));
    closing = Dot(v_TB_W, r_BT_W) / Max(distance, T(1e-9));
  }
};

}  // namespace stg::agent

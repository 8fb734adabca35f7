#pragma once

#include "auv_common/numbers/vector.hpp"

namespace stg::agent {

/// The target estimate as an AUV's knowledge takes it.
template <class T>
struct TargetView {
  Vec3<T> p_WT, v_WT;   ///< [m], [m/s]
  T variance = T(0.0);  ///< of each position component [m^2]
  T started = T(0.0);   ///< 1: there is an estimate
  T current = T(0.0);   ///< 1: it rests on a recent observation
  T changed = T(0.0);   ///< 1: of another target than at the last decision
};

}  // namespace stg::agent

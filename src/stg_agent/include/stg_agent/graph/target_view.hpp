#pragma once

#include "auv_common/numbers/vector.hpp"

namespace stg::agent {

/// The target estimate for an AUV's knowledge.
template <class T>
struct TargetView {
  Vec3<T> p_WT, v_WT;   ///< [m], [m/s]
  T variance = T(0.0);  ///< of each position component [m^2]
  T started = T(0.0);   ///< 1: there is an estimate
  T current = T(0.0);   ///< 1: it contains a recent observation
  T changed = T(0.0);   ///< 1: another target than at the last decision
};

}  // namespace stg::agent

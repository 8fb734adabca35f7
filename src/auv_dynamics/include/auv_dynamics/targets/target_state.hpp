#pragma once

#include "auv_common/numbers/vector.hpp"

namespace stg::dynamics {

/// A target, world axes.
template <class T>
struct TargetState {
  Vec3<T> p_WT;  ///< position [m]
  Vec3<T> v_WT;  ///< velocity [m/s]
};

}  // namespace stg::dynamics

#pragma once

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/measurements.hpp"
#include "stg_agent/graph/observation_spec.hpp"

/// What one AUV knows when it decides, whoever found it out: an agent by its own means, or the
/// truth mode by looking at true states. T = double: one AUV. T = Pack: the same AUV of kLanes
/// environments.
namespace stg::agent {

/// What one AUV knows at a decision. Lengths [m], world axes unless named.
template <class T>
struct Knowledge {
  // Own navigation.
  Vec3<T> p_WB, v_WB, v_WB_B, w_WB_B;
  Mat3<T> R_WB;
  EulerTrig<T> trig;
  // Target: offset from the AUV (r of Eq. 11) and velocity.
  Vec3<T> r_BT_W, v_WT;
  // Offsets of up to three neighbours; zero where there is none.
  Vec3<T> neighbour[kNeighbourSlots];
  // tau / tau_max of the previous step.
  T tau[dynamics::kWrenchSize] = {T(0.0), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0)};
  // Tracking (Eqs. 1, 12-14).
  T distance = T(0.0);           ///< d
  T previous_distance = T(0.0);  ///< d of the previous decision
  T error = T(0.0);              ///< e
  T mean_error = T(0.0);         ///< mean of e over the last k decisions
  T closing = T(0.0);            ///< closing speed [m/s], positive when approaching
  T confidence = T(0.0);         ///< c
  T lost = T(0.0);               ///< l, 0 or 1
  T lost_steps = T(0.0);         ///< consecutive decisions lost
  // Task graph (Eqs. 18-19) before normalisation.
  T closest = T(0.0);  ///< 1 when no other AUV is closer to the target
  T effective_fraction = T(0.0), mean_quality = T(0.0), best_quality = T(0.0);
  T mean_neighbour_error = T(0.0);
};

}  // namespace stg::agent

#pragma once

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"
#include "stg_agent/graph/observation_spec.hpp"
#include "stg_agent/graph/tracking.hpp"

/// What one AUV knows when it decides, from an agent's estimates or from true states (truth mode).
/// T = double: one AUV. T = Pack: the same AUV of kLanes environments.
namespace stg::agent {

/// Knowledge of one AUV at a decision: Tracking of its target, and the following. Lengths [m],
/// world axes unless named.
template <class T>
struct Knowledge : Tracking<T> {
  // Own navigation.
  Vec3<T> p_WB, v_WB, v_WB_B, w_WB_B;
  T position_std_m = T(0.0);  ///< of each horizontal component of p_WB, as stated; 0: exact
  Mat3<T> R_WB;
  EulerTrig<T> trig;
  Vec3<T> v_WT;  ///< velocity of the target
  // Offsets of up to three neighbours; zero where there is none.
  Vec3<T> neighbour[kNeighbourSlots];
  // tau / tau_max of the previous step; zero where an autopilot steers.
  T tau[dynamics::kWrenchSize] = {T(0.0), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0)};
  // Tracking over time (Eq. 14).
  T mean_error = T(0.0);  ///< mean of e over the last k decisions
  T lost_steps = T(0.0);  ///< consecutive decisions lost
  // Task graph (Eqs. 18-19) before normalisation.
  T closest = T(0.0);  ///< 1 when no other AUV is closer to the target
  T effective_fraction = T(0.0), mean_quality = T(0.0), best_quality = T(0.0);
  T mean_neighbour_error = T(0.0);

  /// Own navigation from the true state, exact.
  void SetNavigation(const dynamics::VehicleState<T>& state) {
    p_WB = state.p_WB;
    v_WB_B = state.v_WB_B;
    w_WB_B = state.w_WB_B;
    R_WB = state.R_WB;
    trig = state.trig;
    v_WB = state.v_WB;
  }
};

}  // namespace stg::agent

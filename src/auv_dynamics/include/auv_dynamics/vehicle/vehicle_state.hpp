#pragma once

#include "auv_common/numbers/attitude.hpp"

namespace stg::dynamics {

/// True state of one vehicle: body B in world W.
template <class T>
struct VehicleState {
  Vec3<T> p_WB;  ///< position [m]
  Vec3<T> rpy;   ///< roll, pitch, yaw [rad]; master copy of the semi-implicit integrator
  T q_WB[4] = {T(1.0), T(0.0), T(0.0), T(0.0)};  ///< w x y z; master copy of all others
  Mat3<T> R_WB;                                  ///< of the attitude above
  EulerTrig<T> trig;                             ///< of the attitude above
  Vec3<T> v_WB_B;                                ///< velocity over ground, body axes [m/s]
  Vec3<T> w_WB_B;                                ///< body rates p q r [rad/s]
  Vec3<T> v_WB;                                  ///< velocity over ground, world axes [m/s]
};

/// Sets R_WB, trig and v_WB from q_WB and v_WB_B, at the end of a step that turned q_WB.
template <class T>
inline void FollowQuaternion(VehicleState<T>* s) {
  s->R_WB = RotationOf(s->q_WB);
  s->trig = TrigOf(s->R_WB);
  s->v_WB = s->R_WB * s->v_WB_B;
}

/// Sets one lane to a given position, attitude and motion, without a step. `trig` and `R_WB` follow
/// from q_WB.
inline void SetState(VehicleState<Pack>* s, int lane, const Vec3<double>& p_WB,
                     const double (&q_WB)[4], const EulerTrig<double>& trig,
                     const Mat3<double>& R_WB, const Vec3<double>& v_WB_B,
                     const Vec3<double>& w_WB_B) {
  SetLane(&s->p_WB, lane, p_WB);
  SetLane(&s->rpy, lane, RpyOf(trig));
  for (int k = 0; k < 4; ++k) SetLane(&s->q_WB[k], lane, q_WB[k]);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) SetLane(&s->R_WB.m[r][c], lane, R_WB.m[r][c]);
  }
  SetLane(&s->trig.sin_phi, lane, trig.sin_phi);
  SetLane(&s->trig.cos_phi, lane, trig.cos_phi);
  SetLane(&s->trig.sin_theta, lane, trig.sin_theta);
  SetLane(&s->trig.cos_theta, lane, trig.cos_theta);
  SetLane(&s->trig.sin_psi, lane, trig.sin_psi);
  SetLane(&s->trig.cos_psi, lane, trig.cos_psi);
  SetLane(&s->v_WB_B, lane, v_WB_B);
  SetLane(&s->w_WB_B, lane, w_WB_B);
  SetLane(&s->v_WB, lane, R_WB * v_WB_B);
}

}  // namespace stg::dynamics

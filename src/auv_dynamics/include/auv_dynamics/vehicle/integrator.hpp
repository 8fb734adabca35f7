#pragma once

#include "auv_dynamics/vehicle/vehicle_model.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"

namespace stg::dynamics {

/// The steps below integrate any rigid body, which has two functions:
///   accelerate(R_WB, nu, c) -> BodyVelocity<T>: nu_dot at attitude and velocity nu, at the time
///       c dt after the start of the step, c in {0, 1/2, 1}
///   limit(nu) -> BodyVelocity<T>: the limited velocity at the end of the step

/// The release's step: velocities by explicit Euler, then position and Euler
/// angles with the new velocities through the old attitude.
template <class T, class Accelerate, class Limit>
void StepSemiImplicit(const Accelerate& accelerate, const Limit& limit, double dt,
                      VehicleState<T>* s) {
  const T h(dt);
  BodyVelocity<T> nu{s->v_WB_B, s->w_WB_B};
  const BodyVelocity<T> a = accelerate(s->R_WB, nu, 0.0);
  nu.v += a.v * h;
  nu.w += a.w * h;
  nu = limit(nu);
  s->v_WB_B = nu.v;
  s->w_WB_B = nu.w;
  s->v_WB = s->R_WB * nu.v;
  s->p_WB += s->v_WB * h;
  const Vec3<T> rates = EulerRates(s->trig, nu.w);
  s->rpy = {WrapAngle(s->rpy.x + rates.x * h), WrapAngle(s->rpy.y + rates.y * h),
            WrapAngle(s->rpy.z + rates.z * h)};
  s->trig = TrigOf(s->rpy);
  s->R_WB = RotationOf(s->trig);
}

/// Classic Runge-Kutta on (p, q, nu); the quaternion is renormalised, so no
/// attitude is singular.
template <class T, class Accelerate, class Limit>
void StepRk4(const Accelerate& accelerate, const Limit& limit, double dt, VehicleState<T>* s) {
  struct Derivative {
    Vec3<T> p, v, w;
    T q[4];
  };
  const auto derive = [&](const T(&q)[4], const BodyVelocity<T>& nu, double c) {
    Derivative d;
    // The norm of a stage's quaternion differs from 1 by O(dt^2). Its matrix must still be a
    // rotation; otherwise the step would depend on the heading.
    const T norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const Mat3<T> R = RotationOf(q, T(2.0) / norm2);
    d.p = R * nu.v;
    const T half(0.5);
    const Vec3<T>& w = nu.w;
    d.q[0] = half * (-q[1] * w.x - q[2] * w.y - q[3] * w.z);
    d.q[1] = half * (q[0] * w.x + q[2] * w.z - q[3] * w.y);
    d.q[2] = half * (q[0] * w.y + q[3] * w.x - q[1] * w.z);
    d.q[3] = half * (q[0] * w.z + q[1] * w.y - q[2] * w.x);
    const BodyVelocity<T> a = accelerate(R, nu, c);
    d.v = a.v;
    d.w = a.w;
    return d;
  };
  const auto at = [&](const Derivative& d, double c) {
    const T step(c * dt);
    T q[4];
    for (int k = 0; k < 4; ++k) q[k] = s->q_WB[k] + d.q[k] * step;
    return derive(q, {s->v_WB_B + d.v * step, s->w_WB_B + d.w * step}, c);
  };
  const Derivative k1 = derive(s->q_WB, {s->v_WB_B, s->w_WB_B}, 0.0);
  const Derivative k2 = at(k1, 0.5);
  const Derivative k3 = at(k2, 0.5);
  const Derivative k4 = at(k3, 1.0);
  const T sixth(dt / 6.0), two(2.0);
  s->p_WB += (k1.p + (k2.p + k3.p) * two + k4.p) * sixth;
  T norm2(0.0);
  for (int k = 0; k < 4; ++k) {
    s->q_WB[k] += (k1.q[k] + (k2.q[k] + k3.q[k]) * two + k4.q[k]) * sixth;
    norm2 += s->q_WB[k] * s->q_WB[k];
  }
  const T inv = T(1.0) / Sqrt(norm2);
  for (int k = 0; k < 4; ++k) s->q_WB[k] *= inv;
  const BodyVelocity<T> nu = limit({s->v_WB_B + (k1.v + (k2.v + k3.v) * two + k4.v) * sixth,
                                    s->w_WB_B + (k1.w + (k2.w + k3.w) * two + k4.w) * sixth});
  s->v_WB_B = nu.v;
  s->w_WB_B = nu.w;
}

/// One physics step of dt under a constant generalised force, by the configured integrator and
/// substeps. R_WB and v_WB are then consistent with attitude and body velocity, except that the
/// semi-implicit step keeps v_WB of the old attitude, as the release does.
template <class T>
void Integrate(const VehicleModel& model, const Wrench<T>& tau, const Vec3<T>& v_WC, double dt,
               VehicleState<T>* s) {
  const auto accelerate = [&](const Mat3<T>& R_WB, const BodyVelocity<T>& nu, double) {
    return model.Acceleration(R_WB, nu, tau, v_WC);
  };
  const auto limit = [&](const BodyVelocity<T>& nu) {
    return model.config().clip_velocity ? model.LimitVelocity(nu) : nu;
  };
  const int n = model.config().substeps;
  const double h = dt / n;
  if (model.config().integrator == Integrator::kSemiImplicit) {
    for (int k = 0; k < n; ++k) StepSemiImplicit(accelerate, limit, h, s);
  } else {
    for (int k = 0; k < n; ++k) StepRk4(accelerate, limit, h, s);
    FollowQuaternion(s);
  }
}

}  // namespace stg::dynamics

#include "stg_agent/estimation/target_track.hpp"

#include <algorithm>
#include <cmath>

namespace stg::agent {
namespace {

/// Stops a target at a wall and reverses this component of its velocity, as the world does.
void ReflectAtWall(double limit, double* p, double* v) {
  if (std::abs(*p) <= limit) return;
  *p = std::copysign(limit, *p);
  if (*p * *v > 0.0) *v = -*v;
}

/// Weight w in [0, 1] that maximises det(w A + (1 - w) B) of two symmetric positive
/// definite 2x2 matrices [a b; b c]: a quadratic in w.
double IntersectionWeight(const double (&A)[3], const double (&B)[3]) {
  const double a = A[0] - B[0], b = A[1] - B[1], c = A[2] - B[2];
  const double f2 = a * c - b * b;
  const double f1 = B[0] * c + B[2] * a - 2.0 * B[1] * b;
  if (f2 < 0.0) return Clip(-0.5 * f1 / f2, 0.0, 1.0);
  return f1 + f2 >= 0.0 ? 1.0 : 0.0;  // convex: the better end, by comparison of det A and det B
}

/// Inverse of the covariance of an estimate.
void Information(const TargetEstimate& e, double (*I)[3]) {
  const double inv = 1.0 / (e.pp * e.vv - e.pv * e.pv);
  (*I)[0] = e.vv * inv;
  (*I)[1] = -e.pv * inv;
  (*I)[2] = e.pp * inv;
}

}  // namespace

TargetTrack::TargetTrack(const AgentModel& model)
    : intensity_(model.track.process_accel_std_mps2 * model.track.process_accel_std_mps2 *
                 model.run.decision_dt_s()),
      floor_std_m_(model.track.measurement_std_m),
      speed_std_mps_(model.track.initial_speed_std_mps),
      max_speed_mps_(model.target.max_speed_mps),
      gate2_(model.track.gate_sigma * model.track.gate_sigma),
      wall_m_(model.wall_m()) {}

void TargetTrack::Clear() {
  started_ = observed_ = false;
  now_ = TargetEstimate();
  shared_ = SharedEstimate();
  previous_rejected_ = stg::dynamics::Detection();
  rejected_ = 0;
}

void TargetTrack::Start(const Vec3<double>& p_WT, double std_m, TimeNs stamp) {
  const double s = Max(std_m, floor_std_m_);
  now_ = TargetEstimate{stamp, p_WT, {}, s * s, 0.0, speed_std_mps_ * speed_std_mps_};
  started_ = true;
  rejected_ = 0;
  Remember(stamp, false);
}

void TargetTrack::Grow(double t, TargetEstimate* e) const {
  e->p_WT += e->v_WT * t;
  ReflectAtWall(wall_m_, &e->p_WT.x, &e->v_WT.x);
  ReflectAtWall(wall_m_, &e->p_WT.y, &e->v_WT.y);
  ReflectAtWall(wall_m_, &e->p_WT.z, &e->v_WT.z);
  const double S = intensity_;
  e->pp += t * (2.0 * e->pv + t * (e->vv + S * t * (1.0 / 3.0)));
  e->pv += t * (e->vv + 0.5 * S * t);
  e->vv += S * t;
}

void TargetTrack::Predict(TimeNs t) {
  if (!started_ || t <= now_.stamp) return;
  Grow(Seconds(t - now_.stamp), &now_);
  now_.stamp = t;
}

void TargetTrack::Remember(TimeNs information, bool observation) {
  observed_ = observation;
  const double back = Seconds(now_.stamp - information);
  shared_ = SharedEstimate{information, now_.p_WT - now_.v_WT * back, now_.v_WT, Sqrt(now_.pp)};
}

void TargetTrack::Detect(const dynamics::Detection& detection) {
  const double std_m = Max(detection.std_m, floor_std_m_);
  if (!started_) {
    Start(detection.p_WT, std_m, detection.stamp);
    observed_ = true;
    return;
  }
  Predict(detection.stamp);
  const double age = Seconds(now_.stamp - detection.stamp);
  const double r = std_m * std_m + age * age * (now_.vv + intensity_ * age * (1.0 / 3.0));
  const Vec3<double> innovation = detection.p_WT + now_.v_WT * age - now_.p_WT;
  const double s = now_.pp + r;
  if (Dot(innovation, innovation) > gate2_ * s) {
    if (++rejected_ >= kRestartAfter) Restart(detection, std_m);
    previous_rejected_ = detection;
    return;
  }
  rejected_ = 0;
  const double k_p = now_.pp / s, k_v = now_.pv / s;
  now_.p_WT += innovation * k_p;
  now_.v_WT += innovation * k_v;
  now_.vv -= k_v * now_.pv;
  now_.pv *= 1.0 - k_p;
  now_.pp *= 1.0 - k_p;
  Remember(std::max(shared_.stamp, detection.stamp), true);
}

void TargetTrack::Restart(const dynamics::Detection& newest, double std_m) {
  // Two-point differencing: the position is the newest one, and the velocity is from the last two.
  const double t = Seconds(newest.stamp - previous_rejected_.stamp);
  Start(newest.p_WT, std_m, newest.stamp);
  observed_ = true;
  if (t <= 0.0) return;
  const Vec3<double> v = (newest.p_WT - previous_rejected_.p_WT) * (1.0 / t);
  if (Norm(v) > 2.0 * max_speed_mps_) return;  // a factor of two leaves room for noise
  now_.v_WT = v;
  const double other = Max(previous_rejected_.std_m, floor_std_m_);
  now_.pv = now_.pp / t;
  now_.vv = (now_.pp + other * other) / (t * t) + intensity_ * t;
  Remember(newest.stamp, true);
}

void TargetTrack::Fuse(const SharedEstimate& shared) {
  const double std_m = Max(shared.std_m, floor_std_m_);
  TargetEstimate other{shared.stamp,  shared.p_WT, shared.v_WT,
                       std_m * std_m, 0.0,         speed_std_mps_ * speed_std_mps_};
  if (!started_) {
    now_ = other;
    started_ = true;
    Remember(shared.stamp, true);
    return;
  }
  if (shared.stamp < now_.stamp) {
    Grow(Seconds(now_.stamp - shared.stamp), &other);
    other.stamp = now_.stamp;
  } else {
    Predict(shared.stamp);
  }
  const Vec3<double> difference = other.p_WT - now_.p_WT;
  if (Dot(difference, difference) > gate2_ * (now_.pp + other.pp)) {
    if (shared.stamp > shared_.stamp && other.pp < now_.pp) {
      now_ = other;
      rejected_ = 0;
      Remember(shared.stamp, true);
    }
    return;
  }
  double A[3], B[3];
  Information(now_, &A);
  Information(other, &B);
  const double w = IntersectionWeight(A, B);
  const double i0 = w * A[0] + (1.0 - w) * B[0];
  const double i1 = w * A[1] + (1.0 - w) * B[1];
  const double i2 = w * A[2] + (1.0 - w) * B[2];
  // Correction form, x = x1 + (1 - w) P B (x2 - x1). It gives exactly x1 if w is 1.
  const double inv = 1.0 / (i0 * i2 - i1 * i1);
  const double pp = i2 * inv, pv = -i1 * inv, vv = i0 * inv;
  const Vec3<double> dv = other.v_WT - now_.v_WT;
  const Vec3<double> y_p = (difference * B[0] + dv * B[1]) * (1.0 - w);
  const Vec3<double> y_v = (difference * B[1] + dv * B[2]) * (1.0 - w);
  now_.p_WT += y_p * pp + y_v * pv;
  now_.v_WT += y_p * pv + y_v * vv;
  now_.pp = pp;
  now_.pv = pv;
  now_.vv = vv;
  Remember(std::max(shared_.stamp, shared.stamp), true);
}

}  // namespace stg::agent

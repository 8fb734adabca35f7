#pragma once

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/vehicle/torpedo_config.hpp"
#include "auv_dynamics/vehicle/vehicle_model.hpp"

namespace stg::dynamics {

/// Actuators of a torpedo, present or commanded. A positive rudder turns to starboard, a positive
/// stern plane lowers the bow, as in the public model.
template <class T>
struct TorpedoActuators {
  T rpm = T(0.0);          ///< shaft speed [rpm], positive ahead
  T rudder = T(0.0);       ///< [rad]
  T stern_plane = T(0.0);  ///< [rad]
};

/// Equations of motion of a torpedo-shaped vehicle under water,
///   (M_RB + M_A) nu_dot + C(nu_r) nu_r + D(nu_r) nu_r + g(eta) = tau(nu_r, actuators) + w,
/// nu_r the velocity through the water (Fossen 2021, Handbook of Marine Craft Hydrodynamics and
/// Motion Control, ch. 8.4), written in body FLU:
/// - the inertia is that of the spheroid, the added mass is by Lamb's factors; the added inertia in
///   roll is 0.3 times the rigid body's;
/// - the linear damping of surge and sway decreases as the speed increases; lift and drag of the
///   hull are those of a wing in the vertical plane (Beard and McLain 2012), and the cross-flow
///   drag of 21 strips in the horizontal plane has Hoerner's coefficient of a circle, 1.1977;
/// - the Coriolis terms of the added mass that couple surge with heave and sway with yaw and pitch
///   are left out, because there is no quadratic rotational damping to balance them;
/// - fins have a lift slope, the propeller has K_T and K_Q over the advance number; astern they
/// have
///   their values at advance number 0.
/// Valid for a neutrally buoyant hull in deep water, ahead, at angles of attack of a few degrees
/// and speeds to about 2.6 m/s. Astern the angle of attack is near pi, where lift and drag are not
/// valid; the terms are those of the public model.
class TorpedoModel {
 public:
  /// Throws UserError when the hull is not longer than it is wide.
  explicit TorpedoModel(const TorpedoConfig& config);

  const TorpedoConfig& config() const { return c_; }
  double mass_kg() const { return m_; }
  /// Diagonal of M_RB + M_A about the body origin, surge to yaw [kg, kg m^2].
  const std::array<double, 6>& inertia() const { return M_; }
  /// Lamb's added mass and inertia, surge to yaw [kg, kg m^2].
  const std::array<double, 6>& added_mass() const { return A_; }

  /// Ratio of shaft speed to forward speed on a steady straight course [rpm per m/s], where thrust
  /// in the wake of the hull equals its drag. Linear damping is neglected, as it is small there.
  double SteadyRpmPerSpeed() const;
  /// Angular acceleration per angle and squared speed [1/m^2].
  double RudderAuthority() const { return 0.5 * c_.length_m * rudder_ / M_[5]; }
  double SternPlaneAuthority() const { return 0.5 * c_.length_m * stern_plane_ / M_[4]; }
  /// Of pitch: damping [1/s], and righting acceleration per sine of pitch [1/s^2].
  double PitchDamping() const { return D_[4] / M_[4]; }
  double Righting() const { return weight_ * c_.cg_below_m / M_[4]; }

  /// Limits a command to the ranges of the actuators.
  template <class T>
  TorpedoActuators<T> Limit(const TorpedoActuators<T>& wanted) const;

  /// Propeller thrust after deduction [N] and its torque on the hull [N m].
  /// @param advance speed for the advance number [m/s]
  template <class T>
  void Propeller(const T& rpm, const T& advance, T* thrust, T* torque) const;

  /// nu_dot.
  /// @param w    force and moment besides those of water, weight and actuators, body axes
  /// @param v_WC current, world axes [m/s]
  template <class T>
  BodyVelocity<T> Acceleration(const Mat3<T>& R_WB, const BodyVelocity<T>& nu,
                               const TorpedoActuators<T>& actuators, const Wrench<T>& w,
                               const Vec3<T>& v_WC) const;

 private:
  static constexpr int kStrips = 10;  // on each side of the middle one

  TorpedoConfig c_;
  double m_, weight_, z_G_;                // z_G_ < 0: below the origin
  std::array<double, 6> A_{}, M_{}, D_{};  // added mass, its sum with the rigid body, damping
  Vec3<double> I_G_;
  double coupling_;                            // m z_G: of surge with pitch, and of sway with roll
  double inverse_xq_, inverse_yp_;             // of the determinants of these two pairs
  double wing_, lift_slope_, CD_0_, induced_;  // 1/2 rho S; C_L = lift_slope alpha; C_D of C_L^2
  double rudder_, stern_plane_;                // 1/2 rho A C_L
  double strip_, step_;                        // 1/2 rho D C_d dx, and dx
  double thrust_, thrust_slope_, torque_, torque_slope_;  // of n |n| and of Va |n|, n in rpm
};

template <class T>
TorpedoActuators<T> TorpedoModel::Limit(const TorpedoActuators<T>& a) const {
  const double n = c_.max_propeller_rpm, fin = c_.max_fin_rad;
  return {Clip(a.rpm, T(-n), T(n)), Clip(a.rudder, T(-fin), T(fin)),
          Clip(a.stern_plane, T(-fin), T(fin))};
}

template <class T>
void TorpedoModel::Propeller(const T& rpm, const T& advance, T* thrust, T* torque) const {
  const T turns = Abs(rpm);
  const T inflow = Select(rpm > T(0.0), advance * turns, T(0.0));
  *thrust = T(thrust_) * turns * rpm + T(thrust_slope_) * inflow;
  *torque = T(torque_) * turns * rpm + T(torque_slope_) * inflow;
}

template <class T>
BodyVelocity<T> TorpedoModel::Acceleration(const Mat3<T>& R_WB, const BodyVelocity<T>& nu,
                                           const TorpedoActuators<T>& act, const Wrench<T>& w,
                                           const Vec3<T>& v_WC) const {
  const T zero(0.0), z(z_G_);
  const Vec3<T> v_c = R_WB.TransposeTimes(v_WC);
  const Vec3<T> v = nu.v - v_c;
  const T &p = nu.w.x, &q = nu.w.y, &r = nu.w.z;
  const T uu = v.x * v.x, vv = v.y * v.y, ww = v.z * v.z;
  const T vertical = uu + ww;  // squared speed in the plane of symmetry
  const T UU = vertical + vv;
  const T U = Sqrt(UU);
  const T fading = Exp(T(-3.0) * U);
  const T thrust_speed = T(c_.propeller_inflow) * (c_.advance_over_ground ? Norm(nu.v) : U);

  // Rigid body: the centre of gravity lies on the body's z axis.
  const Vec3<T> v_G{v.x + q * z, v.y - p * z, v.z};
  const Vec3<T> rigid = Cross(nu.w, v_G) * T(m_);
  Vec3<T> f = w.force - rigid;
  Vec3<T> n = w.moment - Cross(nu.w, Scale(nu.w, I_G_));
  n.x += z * rigid.y;
  n.y = n.y - z * rigid.x;
  // Added mass: the remaining terms of C_A.
  const T momentum_y = T(A_[1]) * v.y, momentum_z = T(A_[2]) * v.z;
  f.y += momentum_z * p;
  f.z = f.z - momentum_y * p;
  n = n - Cross(nu.w, Scale(nu.w, {A_[3], A_[4], A_[5]}));
  // Linear damping.
  f.x = f.x - T(D_[0]) * fading * v.x;
  f.y = f.y - T(D_[1]) * fading * v.y;
  f.z = f.z - T(D_[2]) * v.z;
  n.x = n.x - T(D_[3]) * p;
  n.y = n.y - T(D_[4]) * q;
  n.z = n.z - T(D_[5]) * r;
  // The hull as a wing. At rest there is no angle of attack, and no force.
  const T along = Sqrt(vertical);
  const Mask<T> moving = along > T(1e-12);
  const T inverse = T(1.0) / Select(moving, along, T(1.0));
  const T cosine = v.x * inverse, sine = v.z * inverse;
  const T alpha = Select(moving, Atan2(v.z, Select(moving, v.x, T(1.0))), zero);
  const T CL = T(lift_slope_) * alpha;
  const T lift = T(wing_) * UU * CL;
  const T drag = T(wing_) * UU * (T(CD_0_) + T(induced_) * CL * CL);
  f.x += sine * lift - cosine * drag;
  f.z = f.z - (sine * drag + cosine * lift);
  // Cross-flow: strips at x = i dx, two at a time.
  T side = Abs(v.y) * v.y, turn = zero;
  for (int i = 1; i <= kStrips; ++i) {
    const T arm(i * step_);
    const T fore = v.y + arm * r, aft = v.y - arm * r;
    const T at_fore = Abs(fore) * fore, at_aft = Abs(aft) * aft;
    side += at_fore + at_aft;
    turn += arm * (at_fore - at_aft);
  }
  f.y = f.y - T(strip_) * side;
  n.z = n.z - T(strip_) * turn;
  // Fins at the tail: x = -L / 2.
  const T arm(0.5 * c_.length_m);
  const T rudder = T(rudder_) * (uu + vv) * act.rudder;
  const T stern_plane = T(stern_plane_) * vertical * act.stern_plane;
  f.x = f.x - (rudder * act.rudder + stern_plane * act.stern_plane);
  f.y += rudder;
  f.z += stern_plane;
  n.y += arm * stern_plane;
  n.z = n.z - arm * rudder;
  // Propeller.
  T thrust, torque;
  Propeller(act.rpm, thrust_speed, &thrust, &torque);
  f.x += thrust;
  n.x += torque;
  // Weight at the centre of gravity; the world's z in body axes is the last row of R_WB.
  const T righting(weight_ * z_G_);
  n.x += righting * R_WB.m[2][1];
  n.y = n.y - righting * R_WB.m[2][0];

  // The mass matrix couples surge with pitch and sway with roll: two pairs and two numbers.
  const T c(coupling_);
  BodyVelocity<T> a;
  a.v.x = (f.x * T(M_[4]) - n.y * c) * T(inverse_xq_);
  a.w.y = (n.y * T(M_[0]) - f.x * c) * T(inverse_xq_);
  a.v.y = (f.y * T(M_[3]) + n.x * c) * T(inverse_yp_);
  a.w.x = (n.x * T(M_[1]) + f.y * c) * T(inverse_yp_);
  a.v.z = f.z * T(1.0 / M_[2]);
  a.w.z = n.z * T(1.0 / M_[5]);
  // d/dt of the current in body axes, as the body turns under it.
  a.v = a.v - Cross(nu.w, v_c);
  return a;
}

}  // namespace stg::dynamics

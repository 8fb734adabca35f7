#pragma once

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/measurements.hpp"
#include "auv_dynamics/vehicle/vehicle_config.hpp"

namespace stg::dynamics {

/// Body velocity nu = [u v w p q r], body axes.
template <class T>
struct BodyVelocity {
  Vec3<T> v;  ///< linear [m/s]
  Vec3<T> w;  ///< angular [rad/s]
};

/// Six-degree-of-freedom vehicle of Eq. 3 (Fossen 2011, ch. 6-8):
///   (M_RB + M_A) nu_dot + C_RB(nu) nu + C_A(nu_r) nu_r + D(nu_r) nu_r + g(eta) = tau + w.
/// The added mass is diagonal; the rigid body may have its centre of gravity
/// off the body origin. A current is irrotational and constant in the world, so
/// the equation is solved for the velocity through the water nu_r.
class VehicleModel {
 public:
  /// Throws UserError when M is not positive definite.
  explicit VehicleModel(const VehicleConfig& config);

  const VehicleConfig& config() const { return config_; }
  /// M = M_RB + M_A, row-major 6x6 [kg, kg m, kg m^2], and its inverse.
  const std::array<double, 36>& mass_matrix() const { return M_; }
  const std::array<double, 36>& inverse_mass_matrix() const { return M_inv_; }

  /// C(nu) nu of the rigid body and of the added mass.
  template <class T>
  BodyVelocity<T> Coriolis(const BodyVelocity<T>& nu) const;
  /// D(nu) nu, linear plus quadratic.
  template <class T>
  BodyVelocity<T> Damping(const BodyVelocity<T>& nu) const;
  /// g(eta): weight at the centre of gravity, buoyancy at the centre of buoyancy.
  template <class T>
  BodyVelocity<T> Restoring(const Mat3<T>& R_WB) const;

  /// nu_dot of Eq. 3 under tau (w included) at attitude R_WB in a current of
  /// velocity v_WC (world axes).
  template <class T>
  BodyVelocity<T> Acceleration(const Mat3<T>& R_WB, const BodyVelocity<T>& nu, const Wrench<T>& tau,
                               const Vec3<T>& v_WC) const;

  /// Kinetic energy 1/2 nu^T M nu [J].
  double KineticEnergy(const BodyVelocity<double>& nu) const;

  /// Clips tau to the actuator limits.
  template <class T>
  Wrench<T> Limit(const Wrench<T>& tau) const;
  /// Clips body velocity and rates to the limits of Table S2.
  template <class T>
  BodyVelocity<T> LimitVelocity(const BodyVelocity<T>& nu) const;

 private:
  VehicleConfig config_;
  std::array<double, 36> M_{}, M_inv_{};
  bool diagonal_ = true;  // no coupling: six divisions instead of a 6x6 product
  Vec3<double> r_G_, r_B_, I_G_, A_lin_, A_rot_;
};

template <class T>
BodyVelocity<T> VehicleModel::Coriolis(const BodyVelocity<T>& nu) const {
  const T m(config_.mass_kg);
  BodyVelocity<T> c;
  if (diagonal_) {
    c.v = Cross(nu.w, nu.v) * m;
    c.w = Cross(nu.w, Scale(nu.w, I_G_));
  } else {
    const Vec3<T> r{T(r_G_.x), T(r_G_.y), T(r_G_.z)};
    const Vec3<T> v_G = nu.v + Cross(nu.w, r);
    c.v = Cross(nu.w, v_G) * m;
    // Angular momentum about the centre of gravity, then the moment arm.
    c.w = Cross(nu.w, Scale(nu.w, I_G_)) + Cross(r, c.v);
  }
  if (config_.added_mass_coriolis != AddedMassCoriolis::kOff) {
    const Vec3<T> momentum = Scale(nu.v, A_lin_);
    c.v += Cross(nu.w, momentum);
    c.w += Cross(nu.w, Scale(nu.w, A_rot_));
    if (config_.added_mass_coriolis == AddedMassCoriolis::kFull) c.w += Cross(nu.v, momentum);
  }
  if (config_.reversed_coriolis) return {-c.v, -c.w};
  return c;
}

template <class T>
BodyVelocity<T> VehicleModel::Damping(const BodyVelocity<T>& nu) const {
  const auto& d1 = config_.linear_damping;
  const auto& d2 = config_.quadratic_damping;
  const auto term = [&](size_t k, const T& v) { return (T(d1[k]) + T(d2[k]) * Abs(v)) * v; };
  return {{term(0, nu.v.x), term(1, nu.v.y), term(2, nu.v.z)},
          {term(3, nu.w.x), term(4, nu.w.y), term(5, nu.w.z)}};
}

template <class T>
BodyVelocity<T> VehicleModel::Restoring(const Mat3<T>& R_WB) const {
  const Vec3<T> up{R_WB.m[2][0], R_WB.m[2][1], R_WB.m[2][2]};  // world z in body axes
  const T W(config_.weight_n), B(config_.buoyancy_n);
  const Vec3<T> arm{T(r_G_.x) * W - T(r_B_.x) * B, T(r_G_.y) * W - T(r_B_.y) * B,
                    T(r_G_.z) * W - T(r_B_.z) * B};
  return {up * (W - B), Cross(arm, up)};
}

template <class T>
BodyVelocity<T> VehicleModel::Acceleration(const Mat3<T>& R_WB, const BodyVelocity<T>& nu,
                                           const Wrench<T>& tau, const Vec3<T>& v_WC) const {
  const Vec3<T> v_c = R_WB.TransposeTimes(v_WC);
  const BodyVelocity<T> nu_r{nu.v - v_c, nu.w};
  const BodyVelocity<T> c = Coriolis(nu_r);
  const BodyVelocity<T> d = Damping(nu_r);
  Vec3<T> f = tau.force - c.v - d.v;
  Vec3<T> n = tau.moment - c.w - d.w;
  if (config_.restoring) {
    const BodyVelocity<T> g = Restoring(R_WB);
    f = f - g.v;
    n = n - g.w;
  }
  BodyVelocity<T> a;
  const auto& Mi = M_inv_;
  if (diagonal_) {
    a.v = {f.x * T(Mi[0]), f.y * T(Mi[7]), f.z * T(Mi[14])};
    a.w = {n.x * T(Mi[21]), n.y * T(Mi[28]), n.z * T(Mi[35])};
  } else {
    const auto row = [&](size_t r) {
      return T(Mi[r]) * f.x + T(Mi[r + 1]) * f.y + T(Mi[r + 2]) * f.z + T(Mi[r + 3]) * n.x +
             T(Mi[r + 4]) * n.y + T(Mi[r + 5]) * n.z;
    };
    a.v = {row(0), row(6), row(12)};
    a.w = {row(18), row(24), row(30)};
  }
  // d/dt of the current in body axes, as the body turns under it.
  a.v = a.v - Cross(nu.w, v_c);
  return a;
}

template <class T>
Wrench<T> VehicleModel::Limit(const Wrench<T>& tau) const {
  const auto& t = config_.max_tau;
  return {{Clip(tau.force.x, -t[0], t[0]), Clip(tau.force.y, -t[1], t[1]),
           Clip(tau.force.z, -t[2], t[2])},
          {Clip(tau.moment.x, -t[3], t[3]), Clip(tau.moment.y, -t[4], t[4]),
           Clip(tau.moment.z, -t[5], t[5])}};
}

template <class T>
BodyVelocity<T> VehicleModel::LimitVelocity(const BodyVelocity<T>& nu) const {
  const auto& v = config_.max_velocity_mps;
  const auto& w = config_.max_rate_radps;
  return {{Clip(nu.v.x, -v[0], v[0]), Clip(nu.v.y, -v[1], v[1]), Clip(nu.v.z, -v[2], v[2])},
          {Clip(nu.w.x, -w[0], w[0]), Clip(nu.w.y, -w[1], w[1]), Clip(nu.w.z, -w[2], w[2])}};
}

}  // namespace stg::dynamics

#include "auv_dynamics/vehicle/torpedo_model.hpp"

#include <cmath>

#include "auv_common/error.hpp"

namespace stg::dynamics {
namespace {

constexpr double kGravity = 9.81;
constexpr double kAddedRoll = 0.3;  // share of the rigid body's moment of inertia
constexpr double kWingArea = 0.7;   // share of L D
constexpr double kOswald = 0.7;
constexpr double kHoernerCircle = 1.1977;  // cross-flow coefficient at beam = draught

double Square(double x) { return x * x; }

/// Lamb's factors of a prolate spheroid with this eccentricity: along, across, turning.
struct Lamb {
  explicit Lamb(double e) {
    const double ee = e * e, log = std::log((1.0 + e) / (1.0 - e));
    const double alpha = 2.0 * (1.0 - ee) / (ee * e) * (0.5 * log - e);
    const double beta = 1.0 / ee - (1.0 - ee) / (2.0 * ee * e) * log;
    along = alpha / (2.0 - alpha);
    across = beta / (2.0 - beta);
    turning = ee * ee * (beta - alpha) / ((2.0 - ee) * (2.0 * ee - (2.0 - ee) * (beta - alpha)));
  }
  double along, across, turning;
};

}  // namespace

TorpedoModel::TorpedoModel(const TorpedoConfig& c) : c_(c), z_G_(-c.cg_below_m) {
  const double a = 0.5 * c.length_m, b = 0.5 * c.diameter_m, rho = c.water_density_kgpm3;
  if (!(a > b)) throw UserError("vehicle.torpedo: length_m must be larger than diameter_m");
  m_ = 4.0 / 3.0 * kPi * rho * a * b * b;
  weight_ = m_ * kGravity;
  I_G_ = {0.4 * m_ * b * b, 0.2 * m_ * (a * a + b * b), 0.2 * m_ * (a * a + b * b)};
  const Lamb k(std::sqrt(1.0 - Square(b / a)));
  A_ = {m_ * k.along,        m_ * k.across,      m_ * k.across,
        kAddedRoll * I_G_.x, k.turning * I_G_.y, k.turning * I_G_.z};
  const double offset = m_ * z_G_ * z_G_;
  M_ = {m_ + A_[0],    m_ + A_[1], m_ + A_[2], I_G_.x + offset + A_[3], I_G_.y + offset + A_[4],
        I_G_.z + A_[5]};
  coupling_ = m_ * z_G_;
  inverse_xq_ = 1.0 / (M_[0] * M_[4] - Square(coupling_));
  inverse_yp_ = 1.0 / (M_[1] * M_[3] - Square(coupling_));
  const double stiffness = weight_ * c.cg_below_m;
  D_ = {M_[0] / c.surge_time_s,
        M_[1] / c.sway_time_s,
        M_[2] / c.heave_time_s,
        M_[3] * 2.0 * c.roll_damping * std::sqrt(stiffness / M_[3]),
        M_[4] * 2.0 * c.pitch_damping * std::sqrt(stiffness / M_[4]),
        M_[5] / c.yaw_time_s};

  const double S = kWingArea * c.length_m * c.diameter_m;
  const double aspect = Square(c.diameter_m) / S;
  wing_ = 0.5 * rho * S;
  lift_slope_ = kPi * aspect / (1.0 + std::sqrt(1.0 + Square(0.5 * aspect)));
  CD_0_ = c.drag_coefficient * kPi * b * b / S;
  induced_ = 1.0 / (kOswald * kPi * aspect);
  rudder_ = 0.5 * rho * c.fin_area_m2 * c.rudder_lift;
  stern_plane_ = 0.5 * rho * c.fin_area_m2 * c.stern_plane_lift;
  step_ = c.length_m / (2 * kStrips);
  strip_ = 0.5 * rho * c.diameter_m * kHoernerCircle * step_;

  const double D = c.propeller_diameter_m, per_turn = 1.0 / 60.0;
  const auto slope = [&](const std::array<double, 2>& K) {
    return (K[1] - K[0]) / c.propeller_advance / D * per_turn;
  };
  const double force = (1.0 - c.thrust_deduction) * rho * Square(Square(D));
  const double moment = c.torque_share * rho * Square(Square(D)) * D;
  thrust_ = force * c.thrust_coefficient[0] * Square(per_turn);
  thrust_slope_ = force * slope(c.thrust_coefficient);
  torque_ = moment * c.torque_coefficient[0] * Square(per_turn);
  torque_slope_ = moment * slope(c.torque_coefficient);
}

double TorpedoModel::SteadyRpmPerSpeed() const {
  // Root of thrust n^2 + slope inflow u n = drag u^2, divided by u^2.
  const double a = thrust_, b = thrust_slope_ * c_.propeller_inflow, drag = wing_ * CD_0_;
  return (-b + std::sqrt(b * b + 4.0 * a * drag)) / (2.0 * a);
}

}  // namespace stg::dynamics

#include "auv_dynamics/vehicle/vehicle_model.hpp"

#include <Eigen/Dense>

#include "auv_common/error.hpp"

namespace stg::dynamics {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Eigen::Matrix3d Skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d s;
  s << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return s;
}

}  // namespace

VehicleModel::VehicleModel(const VehicleConfig& config)
    : config_(config),
      r_G_{config.r_BG_m[0], config.r_BG_m[1], config.r_BG_m[2]},
      r_B_{config.r_BB_m[0], config.r_BB_m[1], config.r_BB_m[2]},
      I_G_{config.inertia_kgm2[0], config.inertia_kgm2[1], config.inertia_kgm2[2]},
      A_lin_{-config.added_mass[0], -config.added_mass[1], -config.added_mass[2]},
      A_rot_{-config.added_mass[3], -config.added_mass[4], -config.added_mass[5]} {
  const Eigen::Vector3d r(config.r_BG_m[0], config.r_BG_m[1], config.r_BG_m[2]);
  const double m = config.mass_kg;
  Matrix6 M = Matrix6::Zero();
  M.topLeftCorner<3, 3>() = m * Eigen::Matrix3d::Identity();
  M.topRightCorner<3, 3>() = -m * Skew(r);
  M.bottomLeftCorner<3, 3>() = m * Skew(r);
  M.bottomRightCorner<3, 3>() = -m * Skew(r) * Skew(r);
  for (int k = 0; k < 3; ++k) M(3 + k, 3 + k) += config.inertia_kgm2[static_cast<size_t>(k)];
  for (int k = 0; k < 6; ++k) M(k, k) -= config.added_mass[static_cast<size_t>(k)];
  const Eigen::LLT<Matrix6> llt(M);
  if (llt.info() != Eigen::Success || !M.allFinite()) {
    throw UserError("vehicle: the mass matrix M_RB + M_A is not positive definite");
  }
  const Matrix6 inverse = llt.solve(Matrix6::Identity());
  std::copy(M.data(), M.data() + 36, M_.begin());
  std::copy(inverse.data(), inverse.data() + 36, M_inv_.begin());
  diagonal_ = r.isZero(0.0);
}

double VehicleModel::KineticEnergy(const BodyVelocity<double>& nu) const {
  Eigen::Matrix<double, 6, 1> x;
  x << nu.v.x, nu.v.y, nu.v.z, nu.w.x, nu.w.y, nu.w.z;
  return 0.5 * x.dot(Eigen::Map<const Matrix6>(M_.data()) * x);
}

}  // namespace stg::dynamics

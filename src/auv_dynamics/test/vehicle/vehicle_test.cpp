#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "auv_common/error.hpp"
#include "auv_dynamics/vehicle/vehicle_model.hpp"
#include "physics.hpp"

namespace stg::dynamics {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Matrix6 Matrix(const std::array<double, 36>& a) { return Eigen::Map<const Matrix6>(a.data()); }

VehicleConfig WithOffset(VehicleConfig c) {
  c.r_BG_m = {0.03, -0.02, -0.05};
  return c;
}

TEST(Vehicle, MassMatrixIsSymmetricPositiveDefinite) {
  for (const VehicleConfig& c : {FreeVehicle(), WithOffset(FreeVehicle()), ReleaseVehicle()}) {
    const VehicleModel model(c);
    const Matrix6 M = Matrix(model.mass_matrix());
    EXPECT_LT((M - M.transpose()).norm(), 1e-15);
    const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(M);
    EXPECT_GT(eigen.eigenvalues().minCoeff(), 0.0);
    EXPECT_LT((M * Matrix(model.inverse_mass_matrix()) - Matrix6::Identity()).norm(), 1e-12);
  }
}

TEST(Vehicle, MassMatrixHoldsTableS2AndFossensCoupling) {
  VehicleConfig c = FreeVehicle();
  c.r_BG_m = {0.1, 0.2, 0.3};
  const Matrix6 M = Matrix(VehicleModel(c).mass_matrix());
  EXPECT_DOUBLE_EQ(M(0, 0), 31.9 + 2.0);
  EXPECT_DOUBLE_EQ(M(1, 1), 31.9 + 35.0);
  EXPECT_DOUBLE_EQ(M(2, 2), 31.9 + 35.0);
  EXPECT_DOUBLE_EQ(M(3, 3), 0.16 + 0.12 + 31.9 * (0.04 + 0.09));
  EXPECT_DOUBLE_EQ(M(0, 4), 31.9 * 0.3);
  EXPECT_DOUBLE_EQ(M(0, 5), -31.9 * 0.2);
  EXPECT_DOUBLE_EQ(M(1, 5), 31.9 * 0.1);
  EXPECT_DOUBLE_EQ(M(3, 4), -31.9 * 0.1 * 0.2);
}

TEST(Vehicle, MassMatrixThatIsNotPositiveDefiniteIsRefused) {
  VehicleConfig c = FreeVehicle();
  c.added_mass[0] = 40.0;  // in Fossen's sign this would make the surge mass negative
  EXPECT_THROW(VehicleModel{c}, UserError);
}

TEST(Vehicle, CoriolisMatchesHandValues) {
  const BodyVelocity<double> nu{{1.0, 0.5, -0.2}, {0.1, -0.3, 0.4}};
  VehicleConfig c = FreeVehicle();
  c.added_mass_coriolis = AddedMassCoriolis::kOff;
  const BodyVelocity<double> rigid = VehicleModel(c).Coriolis(nu);
  EXPECT_NEAR(rigid.v.x, 31.9 * -0.14, 1e-12);
  EXPECT_NEAR(rigid.v.y, 31.9 * 0.42, 1e-12);
  EXPECT_NEAR(rigid.v.z, 31.9 * 0.35, 1e-12);
  EXPECT_NEAR(rigid.w.x, 0.0, 1e-12);
  EXPECT_NEAR(rigid.w.y, -0.1576, 1e-12);
  EXPECT_NEAR(rigid.w.z, -0.1182, 1e-12);

  c.added_mass_coriolis = AddedMassCoriolis::kNoMunk;
  const BodyVelocity<double> no_munk = VehicleModel(c).Coriolis(nu);
  EXPECT_NEAR(no_munk.v.x - rigid.v.x, -4.9, 1e-12);
  EXPECT_NEAR(no_munk.v.y - rigid.v.y, 1.5, 1e-12);
  EXPECT_NEAR(no_munk.v.z - rigid.v.z, 2.35, 1e-12);
  EXPECT_NEAR(no_munk.w.y - rigid.w.y, -0.1752, 1e-12);
  EXPECT_NEAR(no_munk.w.z - rigid.w.z, -0.1314, 1e-12);

  c.added_mass_coriolis = AddedMassCoriolis::kFull;
  const BodyVelocity<double> full = VehicleModel(c).Coriolis(nu);
  EXPECT_NEAR(Norm(full.v - no_munk.v), 0.0, 1e-12);
  EXPECT_NEAR(full.w.x - no_munk.w.x, 0.0, 1e-12);
  EXPECT_NEAR(full.w.y - no_munk.w.y, 6.6, 1e-12);
  EXPECT_NEAR(full.w.z - no_munk.w.z, 16.5, 1e-12);
}

TEST(Vehicle, CoriolisDoesNoWork) {
  std::mt19937_64 random(1);
  for (const auto part : {AddedMassCoriolis::kFull, AddedMassCoriolis::kOff}) {
    for (const bool offset : {false, true}) {
      for (const bool reversed : {false, true}) {
        VehicleConfig c = offset ? WithOffset(FreeVehicle()) : FreeVehicle();
        c.added_mass_coriolis = part;
        c.reversed_coriolis = reversed;
        const VehicleModel model(c);
        double largest = 0.0;
        for (int n = 0; n < 1000; ++n) {
          const BodyVelocity<double> nu = RandomVelocity(&random);
          const BodyVelocity<double> force = model.Coriolis(nu);
          EXPECT_NEAR(Power(nu, force), 0.0, 1e-12);
          largest = std::max(largest, Norm(force.v));
        }
        EXPECT_GT(largest, 10.0);  // the forces are not zero
      }
    }
  }
}

TEST(Vehicle, CoriolisWithoutMunkMomentDoesTheWorkOfThatMoment) {
  // Without the Munk moment v x A v, C is not skew-symmetric.
  std::mt19937_64 random(2);
  const VehicleModel model(FreeVehicle());
  double largest = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const BodyVelocity<double> nu = RandomVelocity(&random);
    const Vec3<double> Av{2.0 * nu.v.x, 35.0 * nu.v.y, 35.0 * nu.v.z};
    const double munk = Dot(nu.w, Cross(nu.v, Av));
    EXPECT_NEAR(Power(nu, model.Coriolis(nu)), -munk, 1e-11);
    largest = std::max(largest, std::abs(munk));
  }
  EXPECT_GT(largest, 1.0);
}

TEST(Vehicle, ReversedCoriolisFlipsTheSign) {
  std::mt19937_64 random(3);
  VehicleConfig c = FreeVehicle();
  const VehicleModel right(c);
  c.reversed_coriolis = true;
  const VehicleModel wrong(c);
  const BodyVelocity<double> nu = RandomVelocity(&random);
  EXPECT_GT(Norm(right.Coriolis(nu).v), 1.0);
  EXPECT_EQ(Norm(right.Coriolis(nu).v + wrong.Coriolis(nu).v), 0.0);
  EXPECT_EQ(Norm(right.Coriolis(nu).w + wrong.Coriolis(nu).w), 0.0);
}

TEST(Vehicle, BodyWithOffsetOriginMovesAsTheSameBodyAboutItsCentreOfGravity) {
  VehicleConfig about_origin = WithOffset(FreeVehicle());
  about_origin.added_mass = {};
  about_origin.linear_damping = {};
  about_origin.quadratic_damping = {};
  about_origin.restoring = false;
  VehicleConfig about_gravity = about_origin;
  about_gravity.r_BG_m = {};
  const VehicleModel O(about_origin), G(about_gravity);
  const auto& r_G = about_origin.r_BG_m;
  const Vec3<double> r{r_G[0], r_G[1], r_G[2]};
  std::mt19937_64 random(4);
  const Mat3<double> R = RotationOf(TrigOf(Vec3<double>{0.3, 0.2, -1.0}));
  for (int n = 0; n < 200; ++n) {
    const BodyVelocity<double> nu = RandomVelocity(&random);
    const BodyVelocity<double> nu_G{nu.v + Cross(nu.w, r), nu.w};
    EXPECT_NEAR(O.KineticEnergy(nu), G.KineticEnergy(nu_G), 1e-11);
    const Wrench<double> tau{RandomVector(&random, 20.0), RandomVector(&random, 5.0)};
    const Wrench<double> tau_G{tau.force, tau.moment - Cross(r, tau.force)};
    const BodyVelocity<double> a = O.Acceleration(R, nu, tau, {});
    const BodyVelocity<double> a_G = G.Acceleration(R, nu_G, tau_G, {});
    EXPECT_NEAR(Norm(a.w - a_G.w), 0.0, 1e-9);
    EXPECT_NEAR(Norm(a.v + Cross(a.w, r) - a_G.v), 0.0, 1e-9);
  }
}

TEST(Vehicle, DampingDissipates) {
  const VehicleModel model(FreeVehicle());
  std::mt19937_64 random(5);
  for (int n = 0; n < 1000; ++n) {
    const BodyVelocity<double> nu = RandomVelocity(&random);
    // The smallest linear coefficient of Table S2 bounds the loss from below.
    EXPECT_GE(Power(nu, model.Damping(nu)), 0.8 * Power(nu, nu));
  }
}

TEST(Vehicle, DampingMatchesHandValues) {
  const VehicleModel model(FreeVehicle());
  const BodyVelocity<double> d = model.Damping<double>({{1.5, -0.5, 0.2}, {-1.0, 0.5, -0.4}});
  EXPECT_NEAR(d.v.x, 4.0 * 1.5 + 18.0 * 2.25, 1e-13);
  EXPECT_NEAR(d.v.y, -(8.0 * 0.5 + 30.0 * 0.25), 1e-13);
  EXPECT_NEAR(d.v.z, 10.0 * 0.2 + 35.0 * 0.04, 1e-13);
  EXPECT_NEAR(d.w.x, -(0.8 + 0.25), 1e-13);
  EXPECT_NEAR(d.w.y, 3.0 * 0.5 + 1.2 * 0.25, 1e-13);
  EXPECT_NEAR(d.w.z, -(2.5 * 0.4 + 1.0 * 0.16), 1e-13);
}

TEST(Vehicle, RestoringMomentMatchesTheClosedForm) {
  const VehicleConfig c = FreeVehicle();
  const VehicleModel model(c);
  const double arm = c.buoyancy_n * 0.02;  // the centre of buoyancy is above the origin
  for (const double roll : {-2.0, -0.3, 0.0, 0.3, 1.0}) {
    for (const double pitch : {-1.2, 0.0, 0.4}) {
      const Mat3<double> R = RotationOf(TrigOf(Vec3<double>{roll, pitch, 0.7}));
      const BodyVelocity<double> g = model.Restoring(R);
      EXPECT_NEAR(Norm(g.v), 0.0, 1e-12);
      EXPECT_NEAR(g.w.x, arm * std::cos(pitch) * std::sin(roll), 1e-12);
      EXPECT_NEAR(g.w.y, arm * std::sin(pitch), 1e-12);
      EXPECT_NEAR(g.w.z, 0.0, 1e-12);
    }
  }
}

TEST(Vehicle, HeavyVehicleSinksWithItsExcessWeight) {
  VehicleConfig c = FreeVehicle();
  c.weight_n = c.buoyancy_n + 5.0;
  const Mat3<double> level = RotationOf(TrigOf(Vec3<double>{}));
  const BodyVelocity<double> a = VehicleModel(c).Acceleration(level, {}, {}, {});
  EXPECT_NEAR(a.v.z, -5.0 / (31.9 + 35.0), 1e-14);
}

TEST(Vehicle, LimitsActOnEachAxisAndBothSigns) {
  const VehicleModel model(FreeVehicle());
  const Vec3<double> much{1e3, 1e3, 1e3}, little{1.0, -2.0, 0.5};
  const Wrench<double> up = model.Limit<double>({much, much}),
                       down = model.Limit<double>({-much, -much});
  const double most[6] = {35.0, 20.0, 20.0, 8.0, 10.0, 10.0};
  const double high[6] = {up.force.x,  up.force.y,  up.force.z,
                          up.moment.x, up.moment.y, up.moment.z};
  const double low[6] = {down.force.x,  down.force.y,  down.force.z,
                         down.moment.x, down.moment.y, down.moment.z};
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(high[k], most[k]);
    EXPECT_EQ(low[k], -most[k]);
  }
  EXPECT_EQ(Norm(model.Limit<double>({little, little}).force - little), 0.0);
  EXPECT_EQ(Norm(model.Limit<double>({little, little}).moment - little), 0.0);

  const BodyVelocity<double> fast = model.LimitVelocity<double>({much, -much});
  EXPECT_EQ(Norm(fast.v - Vec3<double>{1.5, 0.5, 0.5}), 0.0);
  EXPECT_EQ(Norm(fast.w + Vec3<double>{1.2, 1.2, 1.2}), 0.0);
}

}  // namespace
}  // namespace stg::dynamics

#include "auv_dynamics/vehicle/integrator.hpp"

#include <gtest/gtest.h>

#include "physics.hpp"

namespace stg::dynamics {
namespace {

const Wrench<double> kNoForce{};
const Vec3<double> kStill{};

double Distance(const VehicleState<double>& a, const VehicleState<double>& b) {
  double most =
      std::max({Norm(a.p_WB - b.p_WB), Norm(a.v_WB_B - b.v_WB_B), Norm(a.w_WB_B - b.w_WB_B)});
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a.R_WB.m[r][c] - b.R_WB.m[r][c]));
  }
  return most;
}

VehicleState<double> MovingState(const Vec3<double>& rpy) {
  VehicleState<double> s = AtAttitude(rpy);
  s.v_WB_B = {0.6, 0.2, -0.15};
  s.w_WB_B = {0.4, -0.3, 0.5};
  return s;
}

/// Potential energy of weight and buoyancy [J].
double PotentialEnergy(const VehicleConfig& c, const VehicleState<double>& s) {
  const Vec3<double> G{c.r_BG_m[0], c.r_BG_m[1], c.r_BG_m[2]};
  const Vec3<double> B{c.r_BB_m[0], c.r_BB_m[1], c.r_BB_m[2]};
  return c.weight_n * (s.p_WB + s.R_WB * G).z - c.buoyancy_n * (s.p_WB + s.R_WB * B).z;
}

TEST(Integrator, NeutralVehicleAtRestStaysAtRest) {
  for (const VehicleConfig& c : {FreeVehicle(), ReleaseVehicle()}) {
    const VehicleModel model(c);
    VehicleState<double> s = AtAttitude({0.0, 0.0, 1.0});
    const VehicleState<double> start = s;
    Advance(model, kNoForce, kStill, 0.1, 1000, &s);
    EXPECT_LT(Distance(s, start), 1e-12);
    EXPECT_EQ(Norm(s.v_WB), 0.0);
  }
}

TEST(Integrator, UnforcedMotionLosesEnergy) {
  for (const auto part : {AddedMassCoriolis::kFull, AddedMassCoriolis::kOff}) {
    for (const bool restoring : {false, true}) {
      for (const double offset : {0.0, -0.03}) {
        VehicleConfig c = FreeVehicle();
        c.added_mass_coriolis = part;
        c.restoring = restoring;
        c.r_BG_m = {0.0, offset, 0.5 * offset};
        const VehicleModel model(c);
        VehicleState<double> s = MovingState({0.5, -0.4, 0.3});
        const auto energy = [&] {
          return model.KineticEnergy({s.v_WB_B, s.w_WB_B}) +
                 (restoring ? PotentialEnergy(c, s) : 0.0);
        };
        double before = energy();
        const double start = before;
        for (int k = 0; k < 3000; ++k) {
          Advance(model, kNoForce, kStill, 0.01, 1, &s);
          const double now = energy();
          ASSERT_LE(now, before + 1e-12) << "step " << k;
          before = now;
        }
        EXPECT_LT(before, start - 1.0);
      }
    }
  }
}

TEST(Integrator, RightingMomentRights) {
  const VehicleModel model(FreeVehicle());
  for (const Vec3<double>& tilt :
       {Vec3<double>{0.3, 0.0, 0.0}, Vec3<double>{0.0, 0.3, 0.0}, Vec3<double>{-0.3, -0.3, 2.0}}) {
    VehicleState<double> s = AtAttitude(tilt);
    Advance(model, kNoForce, kStill, 0.1, 1200, &s);
    const Vec3<double> rpy = RpyOf(s.trig);
    EXPECT_NEAR(rpy.x, 0.0, 1e-6);
    EXPECT_NEAR(rpy.y, 0.0, 1e-6);
    EXPECT_LT(Norm(s.w_WB_B), 1e-6);
  }
}

TEST(Integrator, TerminalSpeedEqualsClosedForm) {
  // d1 x + d2 x |x| = tau on each axis alone.
  for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicit}) {
    VehicleConfig c = FreeVehicle();
    c.integrator = integrator;
    c.restoring = false;
    const VehicleModel model(c);
    for (size_t axis = 0; axis < 6; ++axis) {
      const double load = axis < 3 ? -10.0 : 2.0;
      double tau[6] = {};
      tau[axis] = load;
      VehicleState<double> s = AtAttitude({});
      Advance(model, {{tau[0], tau[1], tau[2]}, {tau[3], tau[4], tau[5]}}, kStill, 0.1, 2000, &s);
      const double speed[6] = {s.v_WB_B.x, s.v_WB_B.y, s.v_WB_B.z,
                               s.w_WB_B.x, s.w_WB_B.y, s.w_WB_B.z};
      const double d1 = c.linear_damping[axis], d2 = c.quadratic_damping[axis];
      const double expected =
          std::copysign((-d1 + std::sqrt(d1 * d1 + 4.0 * d2 * std::abs(load))) / (2.0 * d2), load);
      for (size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(speed[k], k == axis ? expected : 0.0, 1e-9) << "axis " << axis;
      }
    }
  }
}

TEST(Integrator, YawOfTheWorldChangesNothing) {
  for (const VehicleConfig& c : {FreeVehicle(), ReleaseVehicle()}) {
    const VehicleModel model(c);
    const Wrench<double> tau{{5.0, -2.0, 1.0}, {0.1, -0.2, 0.3}};
    const Vec3<double> current{0.1, -0.2, 0.05};
    const double turn = 1.1;
    const Mat3<double> Z = RotationOf(TrigOf(Vec3<double>{0.0, 0.0, turn}));
    VehicleState<double> a = MovingState({0.2, -0.3, 0.4}),
                         b = MovingState({0.2, -0.3, 0.4 + turn});
    Advance(model, tau, current, 0.05, 100, &a);
    Advance(model, tau, Z * current, 0.05, 100, &b);
    EXPECT_GT(Norm(a.p_WB), 0.1);
    EXPECT_LT(Norm(Z * a.p_WB - b.p_WB), 1e-13);
    EXPECT_LT(Norm(a.v_WB_B - b.v_WB_B), 1e-13);
    EXPECT_LT(Norm(a.w_WB_B - b.w_WB_B), 1e-13);
  }
}

TEST(Integrator, TranslationOfTheWorldChangesNothing) {
  for (VehicleConfig c : {FreeVehicle(), ReleaseVehicle()}) {
    const VehicleModel model(c);
    const Vec3<double> shift{3.0, -7.0, 11.0};
    VehicleState<double> a = MovingState({0.2, -0.3, 0.4}), b = a;
    b.p_WB += shift;
    const Wrench<double> tau{{5.0, -2.0, 1.0}, {0.1, -0.2, 0.3}};
    Advance(model, tau, kStill, 0.05, 100, &a);
    Advance(model, tau, kStill, 0.05, 100, &b);
    b.p_WB = b.p_WB - shift;
    EXPECT_LT(Distance(a, b), 1e-12);
  }
}

TEST(Integrator, AttitudeSurvivesPitch90) {
  // A vehicle that spins about one axis without damping turns by w t, whatever the Euler angles do.
  VehicleConfig c = FreeVehicle();
  c.restoring = false;
  c.linear_damping = {};
  c.quadratic_damping = {};
  const VehicleModel model(c);
  VehicleState<double> s = AtAttitude({});
  s.w_WB_B = {0.0, 1.0, 0.0};
  const double dt = kPi / 200.0;  // step 100 is the vertical, apart from rounding
  for (int k = 1; k <= 1000; ++k) {
    Advance(model, kNoForce, kStill, dt, 1, &s);
    const double norm2 = s.q_WB[0] * s.q_WB[0] + s.q_WB[1] * s.q_WB[1] + s.q_WB[2] * s.q_WB[2] +
                         s.q_WB[3] * s.q_WB[3];
    ASSERT_NEAR(norm2, 1.0, 1e-14);
    const double angle = dt * k;
    ASSERT_NEAR(s.R_WB.m[0][0], std::cos(angle), 1e-8) << "step " << k;
    ASSERT_NEAR(s.R_WB.m[2][0], -std::sin(angle), 1e-8) << "step " << k;
    const Vec3<double> rpy = RpyOf(s.trig);
    ASSERT_TRUE(std::isfinite(rpy.x) && std::isfinite(rpy.y) && std::isfinite(rpy.z));
  }
}

TEST(Integrator, SemiImplicitAttitudeStaysFiniteAndOrthonormalThroughPitch90) {
  VehicleConfig c = ReleaseVehicle();
  const VehicleModel model(c);
  VehicleState<double> s = AtAttitude({0.3, kPi / 2, -0.2});
  for (int k = 0; k < 500; ++k) {
    Advance(model, {{10.0, 3.0, 0.0}, {1.0, 8.0, -6.0}}, kStill, 0.1, 1, &s);
    for (const double x : {s.p_WB.x, s.p_WB.y, s.p_WB.z, s.rpy.x, s.rpy.y, s.rpy.z}) {
      ASSERT_TRUE(std::isfinite(x));
    }
    ASSERT_LT(std::abs(s.rpy.y), kPi + 1e-12);
    const Vec3<double> a{0.6, -0.3, 0.2};
    ASSERT_NEAR(Norm(s.R_WB.TransposeTimes(s.R_WB * a) - a), 0.0, 1e-14);
  }
}

/// Error at dt over error at dt / 2, after 1.6 s of a manoeuvre that is smooth enough to show the
/// order.
double ErrorRatio(Integrator integrator, double dt) {
  VehicleConfig c = FreeVehicle();
  c.integrator = integrator;
  c.added_mass_coriolis = AddedMassCoriolis::kFull;
  c.r_BG_m = {0.0, 0.0, -0.02};
  // |x| x has a kink at 0. Only surge does not cross 0 here.
  for (size_t k = 1; k < 6; ++k) c.quadratic_damping[k] = 0.0;
  const Wrench<double> tau{{8.0, -3.0, 2.0}, {0.2, 0.4, -0.3}};
  const Vec3<double> current{0.1, -0.05, 0.02};
  const auto at = [&](Integrator method, double h) {
    c.integrator = method;
    VehicleState<double> s = MovingState({0.2, -0.3, 0.4});
    Advance(VehicleModel(c), tau, current, h, static_cast<int>(std::lround(1.6 / h)), &s);
    return s;
  };
  const VehicleState<double> exact = at(Integrator::kRk4, 0.0004);
  return Distance(at(integrator, dt), exact) / Distance(at(integrator, 0.5 * dt), exact);
}

TEST(Integrator, Rk4ConvergesAtFourthOrder) {
  EXPECT_NEAR(ErrorRatio(Integrator::kRk4, 0.01), 16.0, 2.5);
  EXPECT_NEAR(ErrorRatio(Integrator::kRk4, 0.005), 16.0, 1.5);
}

TEST(Integrator, SemiImplicitConvergesAtFirstOrder) {
  EXPECT_NEAR(ErrorRatio(Integrator::kSemiImplicit, 0.01), 2.0, 0.1);
}

TEST(Integrator, CurrentDriftEqualsTheCurrent) {
  const Vec3<double> current{0.2, -0.1, 0.05};
  for (const auto part :
       {AddedMassCoriolis::kFull, AddedMassCoriolis::kNoMunk, AddedMassCoriolis::kOff}) {
    VehicleConfig c = FreeVehicle();
    c.added_mass_coriolis = part;
    VehicleState<double> s = AtAttitude({0.0, 0.0, 0.7});
    Advance(VehicleModel(c), kNoForce, current, 0.1, 4000, &s);
    EXPECT_LT(Norm(s.v_WB - current), 1e-8);
    EXPECT_LT(Norm(s.w_WB_B), 1e-8);
  }
}

TEST(Integrator, ConstantCurrentEqualsMovingFrame) {
  // Galilei: with the same velocity through the water, only the drift differs.
  for (const double offset : {0.0, 0.02}) {
    VehicleConfig c = FreeVehicle();
    c.added_mass_coriolis = AddedMassCoriolis::kFull;
    c.r_BG_m = {offset, 0.0, -offset};
    const VehicleModel model(c);
    const Vec3<double> current{0.3, -0.2, 0.1};
    const Wrench<double> tau{{6.0, 2.0, -1.0}, {0.1, -0.2, 0.4}};
    VehicleState<double> still = MovingState({0.2, -0.3, 0.4}), carried = still;
    carried.v_WB_B += carried.R_WB.TransposeTimes(current);
    const double dt = 0.005;
    const int steps = 800;
    Advance(model, tau, kStill, dt, steps, &still);
    Advance(model, tau, current, dt, steps, &carried);
    EXPECT_GT(Norm(still.p_WB), 0.5);
    EXPECT_LT(Norm(carried.p_WB - current * (dt * steps) - still.p_WB), 1e-7);
    EXPECT_LT(Norm(carried.v_WB - current - still.v_WB), 1e-7);
    EXPECT_LT(Norm(carried.w_WB_B - still.w_WB_B), 1e-7);
  }
}

TEST(Integrator, ReleaseStepMatchesHandComputation) {
  const VehicleModel model(ReleaseVehicle());
  VehicleState<double> s = AtAttitude({0.0, 0.0, kPi / 2});
  s.p_WB = {0.1, 0.2, 0.3};
  s.v_WB_B = {0.4, 0.2, -0.1};
  s.w_WB_B = {0.3, -0.2, 0.5};
  Integrate<double>(model, {{10.0, -4.0, 2.0}, {1.0, 0.5, -0.25}}, kStill, 0.1, &s);
  // Reversed Coriolis: the release subtracts m (r v - q w), ...
  const double u = 0.4 + 0.1 * (10.0 - 31.9 * 0.08 - (4.0 * 0.4 + 18.0 * 0.16)) / 33.9;
  const double v = 0.2 + 0.1 * (-4.0 - 31.9 * -0.23 - (8.0 * 0.2 + 30.0 * 0.04)) / 66.9;
  const double w = -0.1 + 0.1 * (2.0 - 31.9 * -0.14 + (10.0 * 0.1 + 35.0 * 0.01)) / 66.9;
  // ... and (Iy - Iz) q r = 0, (Iz - Ix) p r = 3.94 * 0.15, (Ix - Iy) p q = -3.94 * -0.06.
  const double p = 0.3 + 0.1 * (1.0 - (0.8 * 0.3 + 0.25 * 0.09)) / 0.28;
  const double q = -0.2 + 0.1 * (0.5 - 3.94 * 0.15 + (3.0 * 0.2 + 1.2 * 0.04)) / 8.6;
  const double r = 0.5 + 0.1 * (-0.25 - 3.94 * 0.06 - (2.5 * 0.5 + 1.0 * 0.25)) / 8.6;
  EXPECT_NEAR(s.v_WB_B.x, u, 1e-14);
  EXPECT_NEAR(s.v_WB_B.y, v, 1e-14);
  EXPECT_NEAR(s.v_WB_B.z, w, 1e-14);
  EXPECT_NEAR(s.w_WB_B.x, p, 1e-14);
  EXPECT_NEAR(s.w_WB_B.y, q, 1e-14);
  EXPECT_NEAR(s.w_WB_B.z, r, 1e-14);
  // The old attitude turns the new velocity: the bow points along world y.
  EXPECT_NEAR(s.p_WB.x, 0.1 - 0.1 * v, 1e-14);
  EXPECT_NEAR(s.p_WB.y, 0.2 + 0.1 * u, 1e-14);
  EXPECT_NEAR(s.p_WB.z, 0.3 + 0.1 * w, 1e-14);
  // The vehicle was level before the step, so the Euler rates are the new body rates.
  EXPECT_NEAR(s.rpy.x, 0.1 * p, 1e-14);
  EXPECT_NEAR(s.rpy.y, 0.1 * q, 1e-14);
  EXPECT_NEAR(s.rpy.z, kPi / 2 + 0.1 * r, 1e-14);
}

TEST(Integrator, VelocityLimitsHoldWhenAskedFor) {
  for (VehicleConfig c : {VehicleConfig{}, ReleaseVehicle()}) {
    const VehicleModel model(c);
    VehicleState<double> s = AtAttitude({});
    Advance(model, {{200.0, -200.0, 200.0}, {0.0, 0.0, 10.0}}, kStill, 0.1, 100, &s);
    EXPECT_LE(std::abs(s.v_WB_B.x), 1.5);
    EXPECT_LE(std::abs(s.v_WB_B.y), 0.5);
    EXPECT_LE(std::abs(s.v_WB_B.z), 0.5);
    EXPECT_EQ(std::max({std::abs(s.v_WB_B.y), std::abs(s.v_WB_B.z)}), 0.5);
    EXPECT_LE(std::abs(s.w_WB_B.z), 1.2);
  }
}

TEST(Integrator, SubstepsEqualSmallerSteps) {
  for (VehicleConfig c : {FreeVehicle(), ReleaseVehicle()}) {
    const VehicleModel coarse(c);
    c.substeps = 4;
    const VehicleModel fine(c);
    VehicleState<double> a = MovingState({0.2, -0.3, 0.4}), b = a;
    const Wrench<double> tau{{5.0, -2.0, 1.0}, {0.1, -0.2, 0.3}};
    Advance(fine, tau, kStill, 0.1, 10, &a);
    Advance(coarse, tau, kStill, 0.025, 40, &b);
    EXPECT_EQ(Distance(a, b), 0.0);
  }
}

}  // namespace
}  // namespace stg::dynamics

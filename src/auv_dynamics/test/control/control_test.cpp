#include "auv_dynamics/control/control.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "physics.hpp"

namespace stg::dynamics {
namespace {

TEST(Control, SmoothingMatchesEquation27ByHand) {
  ControlConfig c;  // max_delta 0.35, alpha 0.20
  double previous[3] = {0.0, 0.5, -0.2};
  const double action[3] = {1.0, 0.4, -5.0};
  SmoothAction(c, 3, action, previous);
  EXPECT_NEAR(previous[0], 0.8 * 0.35, 1e-15);                       // rate limited
  EXPECT_NEAR(previous[1], 0.8 * 0.4 + 0.2 * 0.5, 1e-15);            // only smoothed
  EXPECT_NEAR(previous[2], 0.8 * (-0.2 - 0.35) - 0.2 * 0.2, 1e-15);  // clipped, then limited
  SmoothAction(c, 3, action, previous);
  EXPECT_NEAR(previous[0], 0.8 * (0.28 + 0.35) + 0.2 * 0.28, 1e-15);  // against the smoothed
}

TEST(Control, SmoothingAndRateLimitOfZeroPassTheClippedActionThrough) {
  ControlConfig c;
  c.max_delta = 0.0;
  c.smoothing = 0.0;
  double previous[6] = {};
  const double action[6] = {0.3, -0.7, 2.0, -9.0, 1.0, 0.0};
  SmoothAction(c, 6, action, previous);
  const double expected[6] = {0.3, -0.7, 1.0, -1.0, 1.0, 0.0};
  for (int k = 0; k < 6; ++k) EXPECT_EQ(previous[k], expected[k]);
}

TEST(Control, SmoothedActionReachesAHeldActionAndNeverJumps) {
  const ControlConfig c;
  double previous[3] = {-1.0, 0.0, 1.0};
  const double action[3] = {1.0, 1.0, -1.0};
  for (int n = 0; n < 60; ++n) {
    const double before[3] = {previous[0], previous[1], previous[2]};
    SmoothAction(c, 3, action, previous);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(std::abs(previous[k] - before[k]), 0.8 * 0.35 + 1e-15);
    }
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(previous[k], action[k], 1e-12);
}

TEST(Control, FullActionAsksForMaximumSpeedAndForce) {
  const VehicleConfig v;
  const double action[6] = {1.0, -1.0, 0.5, -0.25, 1.0, -1.0};
  const Vec3<double> speed = DesiredVelocity(v, action);
  EXPECT_EQ(Norm(speed - Vec3<double>{1.5, -0.5, 0.25}), 0.0);
  const Wrench<double> tau = ScaleWrench(v, action);
  EXPECT_EQ(Norm(tau.force - Vec3<double>{35.0, -20.0, 10.0}), 0.0);
  EXPECT_EQ(Norm(tau.moment - Vec3<double>{-2.0, 10.0, -10.0}), 0.0);
}

TEST(Control, VelocityControllerMatchesHandValues) {
  const VehicleConfig v;
  const ControlConfig c;
  // The bow points along world y, so the world errors (-0.1, 0.3, 0.05) are (0.3, 0.1, 0.05) in
  // body axes.
  const Vec3<double> rpy{0.0, 0.0, kPi / 2};
  const Mat3<double> R = RotationOf(TrigOf(rpy));
  double fraction[6];
  VelocityController<double>(c, v, {0.1, 0.5, 0.05}, R, {0.2, 0.2, 0.0}, {0.2, -0.4, kPi / 2},
                             {0.6, -0.3, 1.2}, fraction);
  EXPECT_NEAR(fraction[0], 0.3 / 1.5, 1e-15);
  EXPECT_NEAR(fraction[1], 0.1 / 0.5, 1e-15);
  EXPECT_NEAR(fraction[2], 0.05 / 0.5, 1e-15);
  EXPECT_NEAR(fraction[3], -0.12 * 0.2 - 0.10 * 0.5, 1e-15);
  EXPECT_NEAR(fraction[4], 0.12 * 0.4 + 0.10 * 0.25, 1e-15);
  EXPECT_NEAR(fraction[5], -0.10, 1e-15);
}

TEST(Control, VelocityControllerSaturatesAtFullForceAndMoment) {
  const VehicleConfig v;
  ControlConfig c;
  c.attitude_gain = 5.0;
  double fraction[6];
  VelocityController<double>(c, v, {9.0, -9.0, 9.0}, RotationOf(TrigOf(Vec3<double>{})), {},
                             {-3.0, 3.0, 0.0}, {0.0, 0.0, -50.0}, fraction);
  const double expected[6] = {1.0, -1.0, 1.0, 1.0, -1.0, 1.0};
  for (int k = 0; k < 6; ++k) EXPECT_EQ(fraction[k], expected[k]);
}

TEST(Control, NavigationStateGivesTheSameCommandAsTheStateItDescribes) {
  const VehicleConfig v;
  std::mt19937_64 random(1);
  for (const HeadingMode heading : {HeadingMode::kFree, HeadingMode::kAlongVelocity}) {
    ControlConfig c;
    c.heading = heading;
    for (int n = 0; n < 100; ++n) {
      const Vec3<double> rpy = RandomVector(&random, 1.4), wanted = RandomVector(&random, 0.4);
      NavState nav;
      QuaternionOf(rpy, &nav.q_WB);
      nav.v_WB_B = RandomVector(&random, 0.4);
      nav.w_WB_B = RandomVector(&random, 1.0);
      const Mat3<double> R = RotationOf(TrigOf(rpy));
      double from_nav[6], from_state[6];
      VelocityController(c, v, wanted, nav, from_nav);
      VelocityController(c, v, wanted, R, R * nav.v_WB_B, rpy, nav.w_WB_B, from_state);
      for (int k = 0; k < 6; ++k) EXPECT_NEAR(from_nav[k], from_state[k], 1e-12);
    }
  }
}

/// State of a vehicle after `steps` decisions with one commanded world velocity.
VehicleState<double> Follow(const VehicleConfig& v, const ControlConfig& c,
                            const Vec3<double>& wanted, int steps) {
  const VehicleModel model(v);
  VehicleState<double> s = AtAttitude({});
  for (int k = 0; k < steps; ++k) {
    double fraction[6];
    VelocityController(c, v, wanted, s.R_WB, s.v_WB, RpyOf(s.trig), s.w_WB_B, fraction);
    Advance(model, model.Limit(ScaleWrench(v, fraction)), {}, 0.1, 1, &s);
  }
  return s;
}

TEST(Control, HeadingModeTurnsTheBowAlongTheCommand) {
  VehicleConfig v;
  v.restoring = false;  // the righting moment would hold a commanded dive back
  ControlConfig c;
  c.heading = HeadingMode::kAlongVelocity;
  for (const Vec3<double>& wanted :
       {Vec3<double>{0.2, 0.2, 0.0}, Vec3<double>{-0.2, 0.1, 0.05}, Vec3<double>{0.1, -0.3, -0.1},
        Vec3<double>{-0.3, -0.02, 0.1}}) {
    const VehicleState<double> s = Follow(v, c, wanted, 1500);
    const Vec3<double> bow = s.R_WB * Vec3<double>{1.0, 0.0, 0.0};
    EXPECT_GT(Dot(bow, wanted) / Norm(wanted), 0.9999) << wanted.x << " " << wanted.y;
  }
}

TEST(Control, FreeHeadingLeavesTheBowWhereItIs) {
  const VehicleState<double> s = Follow(VehicleConfig{}, ControlConfig{}, {0.0, 0.2, 0.0}, 1000);
  EXPECT_NEAR(RpyOf(s.trig).z, 0.0, 1e-12);
  EXPECT_GT(s.v_WB.y, 0.1);
}

TEST(Control, HeadingModeWithoutACommandOnlyDampsYaw) {
  ControlConfig c;
  c.heading = HeadingMode::kAlongVelocity;
  double fraction[6];
  VelocityController<double>(c, VehicleConfig{}, {},
                             RotationOf(TrigOf(Vec3<double>{0.0, 0.0, 2.0})), {}, {0.0, 0.0, 2.0},
                             {0.0, 0.0, 0.6}, fraction);
  EXPECT_NEAR(fraction[5], -0.05, 1e-15);
  EXPECT_NEAR(fraction[4], 0.0, 1e-15);
}

TEST(ExecuteAction, AForceInterfaceClipsAndAVelocityInterfaceGoesThroughItsController) {
  ControlConfig c;
  const VehicleConfig v;
  const Mat3<double> R_WB = RotationOf(TrigOf(Vec3<double>{0.1, -0.2, 0.7}));
  const Vec3<double> v_WB{0.1, -0.05, 0.02}, w_WB_B{0.1, 0.2, -0.1}, rpy{0.1, -0.2, 0.7};
  const double wanted[] = {0.5, -2.0, 0.25, -0.125, 3.0, 0.0};
  double executed[kMaxActionSize] = {}, fraction[kWrenchSize];
  c.interface = ActionInterface::kTau6;
  const auto never = []() -> Vec3<double> { throw std::logic_error("tau6 needs no angles"); };
  const Vec3<double> none =
      ExecuteAction(c, v, wanted, R_WB, v_WB, never, w_WB_B, executed, fraction);
  EXPECT_EQ(Norm(none), 0.0);
  const double clipped[] = {0.5, -1.0, 0.25, -0.125, 1.0, 0.0};
  for (int k = 0; k < kWrenchSize; ++k) {
    EXPECT_EQ(fraction[k], clipped[k]);
    EXPECT_EQ(executed[k], clipped[k]);
  }
  c.interface = ActionInterface::kVelocity3;
  double smooth[3] = {0.1, 0.2, 0.3}, expected[kWrenchSize];
  std::copy(smooth, smooth + 3, executed);
  SmoothAction(c, 3, wanted, smooth);
  const auto angles = [&rpy] { return rpy; };
  const Vec3<double> v_des_W =
      ExecuteAction(c, v, wanted, R_WB, v_WB, angles, w_WB_B, executed, fraction);
  VelocityController(c, v, DesiredVelocity(v, smooth), R_WB, v_WB, rpy, w_WB_B, expected);
  EXPECT_EQ(v_des_W.y, DesiredVelocity(v, smooth).y);
  for (int k = 0; k < kWrenchSize; ++k) EXPECT_EQ(fraction[k], expected[k]);
  // The action for that velocity is the velocity itself, or under tau6 the force of the controller.
  double action[kMaxActionSize];
  ActionForVelocity(c, v, smooth, R_WB, v_WB, never, w_WB_B, action);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(action[k], smooth[k]);
  c.interface = ActionInterface::kTau6;
  ActionForVelocity(c, v, smooth, R_WB, v_WB, angles, w_WB_B, action);
  for (int k = 0; k < kWrenchSize; ++k) EXPECT_EQ(action[k], expected[k]);
}

}  // namespace
}  // namespace stg::dynamics

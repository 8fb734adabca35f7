#include "auv_dynamics/vehicle/torpedo.hpp"

#include <gtest/gtest.h>

#include "auv_dynamics/playback/recorded_motion.hpp"
#include "auv_dynamics/vehicle/shaft_power.hpp"
#include "physics.hpp"

// The published values come from T. I. Fossen's REMUS 100 model (remus100.py at c717e07), which was
// run unmodified. test/data holds its motions.
namespace stg::dynamics {
namespace {

constexpr double kDeg = kPi / 180.0;
constexpr double kStep_s = 0.05;

/// A torpedo at the origin of still water, level and at rest.
struct Boat {
  explicit Boat(const VehicleConfig& config = {}) : config(config), model(config.torpedo) {
    state = AtAttitude({});
  }
  void Run(double seconds, const TorpedoActuators<double>& command) {
    const int steps = static_cast<int>(std::lround(seconds / kStep_s));
    for (int k = 0; k < steps; ++k) {
      Integrate(model, config, command, w, v_WC, kStep_s, &state, &actuators);
    }
  }
  VehicleConfig config;
  TorpedoModel model;
  VehicleState<double> state;
  TorpedoActuators<double> actuators;
  Wrench<double> w;
  Vec3<double> v_WC;
};

TEST(Torpedo, InertiaAndAddedMassAreThoseOfTheSpheroid) {
  const TorpedoModel model{TorpedoConfig()};
  EXPECT_NEAR(model.mass_kg(), 31.029, 5e-4);
  const double added[] = {.8389, 29.4376, 29.4376, .0336, 3.4262, 3.4262};
  for (size_t k = 0; k < 6; ++k) EXPECT_NEAR(model.added_mass()[k], added[k], 5e-5) << k;
  // The centre of gravity lies 0.02 m below the origin: m z^2 about the axes across it.
  EXPECT_NEAR(model.inertia()[0], 31.0294 + .8389, 1e-3);
  EXPECT_NEAR(model.inertia()[3], .1120 + 31.029 * 4e-4 + .0336, 1e-4);
  EXPECT_NEAR(model.inertia()[4], 4.0278 + 31.029 * 4e-4 + 3.4262, 2e-4);
  EXPECT_NEAR(model.inertia()[5], 4.0278 + 3.4262, 2e-4);
}

TEST(Torpedo, ReachesThePublishedSpeedAndHeel) {
  const double table[][3] = {
      {500, .8314, .111}, {1000, 1.6741, .438}, {1300, 2.1768, .740}, {1525, 2.5536, 1.019}};
  for (const auto& [rpm, u, roll_deg] : table) {
    Boat boat;
    boat.Run(120.0, {rpm, 0.0, 0.0});
    EXPECT_NEAR(boat.state.v_WB_B.x, u, 1e-4) << rpm;
    EXPECT_NEAR(RpyOf(boat.state.trig).x / kDeg, roll_deg, 1e-3) << rpm;
  }
}

TEST(Torpedo, GathersWayAsPublished) {
  Boat boat;
  double time_s = 0.0, reached_s = 0.0;
  while (time_s < 60.0 - 1e-9) {
    boat.Run(kStep_s, {1525.0, 0.0, 0.0});
    time_s += kStep_s;
    if (reached_s == 0.0 && boat.state.v_WB_B.x >= 0.95 * 2.5536) reached_s = time_s;
  }
  EXPECT_NEAR(reached_s, 3.9, 0.1);
  EXPECT_NEAR(boat.state.p_WB.x, 148.35, 0.1);
}

TEST(Torpedo, PropellerPullsAndDrivesAsPublished) {
  const TorpedoModel model{TorpedoConfig()};
  double thrust = 0.0, torque = 0.0;
  model.Propeller(1525.0, 0.0, &thrust, &torque);
  // The published thrust at rest is the propeller's alone. The hull takes back a tenth of it.
  EXPECT_NEAR(thrust, 0.9 * 116.26, 5e-3);
  model.Propeller(1525.0, 0.944 * 2.5536, &thrust, &torque);
  EXPECT_NEAR(thrust, 39.84, 5e-3);
  EXPECT_GT(torque, 0.0);
  // Astern, the coefficients of advance number 0 apply.
  model.Propeller(-1525.0, 0.944 * 2.5536, &thrust, &torque);
  EXPECT_NEAR(thrust, -0.9 * 116.26, 5e-3);
}

TEST(Torpedo, ShaftPowerIsThatOfTheTorqueAtTheAdvanceNumber) {
  const TorpedoConfig c;
  const TorpedoModel model{c};
  // P = 2 pi n rho n^2 D^5 K_Q(J), by hand at 1000 rpm: at rest, and at the speed of that rate.
  const double n = 1000.0 / 60.0, D = c.propeller_diameter_m;
  const auto power = [&](double speed) {
    const double J = c.propeller_inflow * speed / (n * D);
    const double K_Q = 0.07 + (0.0312 - 0.07) / 0.6632 * J;
    return 2.0 * kPi * n * 1026.0 * n * n * std::pow(D, 5) * K_Q;
  };
  EXPECT_NEAR(ShaftPower(c, 1000.0, 0.0), power(0.0), 1e-9);
  EXPECT_NEAR(ShaftPower(c, 1000.0, 1.6741), power(1.6741), 1e-9);
  // The power is the torque on the hull, over its share, times the rate.
  double thrust = 0.0, torque = 0.0;
  model.Propeller(1000.0, 0.944 * 1.6741, &thrust, &torque);
  EXPECT_NEAR(ShaftPower(c, 1000.0, 1.6741), 2.0 * kPi * n * torque / c.torque_share, 1e-9);
  // Thrust times speed is less than the power of the shaft. A stopped shaft takes no power.
  EXPECT_LT(thrust * 1.6741, ShaftPower(c, 1000.0, 1.6741));
  EXPECT_EQ(ShaftPower(c, 0.0, 2.0), 0.0);
  EXPECT_EQ(ShaftPower(c, 50.0, 2.5), 0.0) << "the water turns the propeller";
  EXPECT_GT(ShaftPower(c, -1000.0, 1.0), 0.0);
}

TEST(Torpedo, TurnsAtThePublishedRateAndRadius) {
  const double table[][3] = {
      {2, 1.838, 79.5}, {5, 3.609, 40.4}, {10, 5.894, 24.6}, {15, 7.767, 18.5}};
  for (const auto& [rudder_deg, rate_degps, radius_m] : table) {
    Boat boat;
    boat.Run(120.0, {1525.0, rudder_deg * kDeg, 0.0});
    // Positive rudder turns to starboard: clockwise from above, which is a negative yaw rate in
    // ENU.
    const double rate = -boat.state.w_WB_B.z;
    EXPECT_NEAR(rate / kDeg, rate_degps, 2e-3) << rudder_deg;
    const double speed = std::hypot(boat.state.v_WB.x, boat.state.v_WB.y);
    EXPECT_NEAR(speed / rate, radius_m, 0.1) << rudder_deg;
  }
}

TEST(Torpedo, PositiveSternPlaneDives) {
  Boat boat;
  boat.Run(10.0, {1300.0, 0.0, 3.0 * kDeg});
  EXPECT_GT(RpyOf(boat.state.trig).y, 0.0);
  EXPECT_LT(boat.state.p_WB.z, -1.0);
}

TEST(Torpedo, FliesThePublishedMotions) {
  const auto motions = LoadMotions(STG_TEST_DATA "/remus100.csv");
  std::vector<RecordedMotion> still;
  for (const auto& m : motions) {
    if (m.current_mps == 0.0) still.push_back(m);
  }
  ASSERT_EQ(motions.size(), 8u);
  ASSERT_EQ(still.size(), 7u);
  // With the step of the public model, the equations agree to five digits ...
  VehicleConfig config;
  config.integrator = Integrator::kSemiImplicit;
  const MotionError same = Compare(config, still, 0.02);
  EXPECT_TRUE(same.Within(5e-5));
  EXPECT_EQ(same.rows, 54);
  // ... also in its current. There its propeller takes in the speed over ground, and its current
  // lacks one part at pitch: u sin(pitch) across the bow.
  config.torpedo.advance_over_ground = true;
  const MotionError moved = Compare(config, motions, 0.02);
  EXPECT_LT(moved.columns[kU].share(), 1e-3);
  EXPECT_LT(moved.columns[kV].share(), 1e-3);
  EXPECT_LT(moved.columns[kPsi].max_abs_error, 2e-4);
  EXPECT_LT(moved.position_share, 1e-3);
  // The product's step has almost no error of its own. It keeps within 1 % of all rates except the
  // quickest one, roll in the first second of a hard turn.
  config = VehicleConfig();
  const MotionError exact = Compare(config, still, 0.05);
  EXPECT_TRUE(exact.Within(0.014));
  EXPECT_LT(exact.position_share, 1e-3);
}

TEST(Torpedo, RungeKuttaConvergesAtFiftyMilliseconds) {
  const auto motions = LoadMotions(STG_TEST_DATA "/remus100.csv");
  VehicleConfig config;
  for (const RecordedMotion& m : motions) {
    Boat coarse(config), fine(config);
    fine.config.substeps = 10;
    const TorpedoActuators<double> command{m.rpm, m.rudder_deg * kDeg, m.stern_deg * kDeg};
    coarse.Run(60.0, command);
    fine.Run(60.0, command);
    EXPECT_LT(Norm(coarse.state.p_WB - fine.state.p_WB), 1e-3);
    EXPECT_LT(Norm(coarse.state.v_WB_B - fine.state.v_WB_B), 1e-5);
  }
}

TEST(Torpedo, AChangedConstantIsFoundInTheMotions) {
  const auto motions = LoadMotions(STG_TEST_DATA "/remus100.csv");
  VehicleConfig config;
  config.integrator = Integrator::kSemiImplicit;
  config.torpedo.drag_coefficient *= 1.05;
  EXPECT_FALSE(Compare(config, motions, 0.02).Within(0.01));
}

TEST(Torpedo, ActuatorsLagExactlyAndStopAtTheirLimits) {
  Boat boat;
  const TorpedoActuators<double> wild{1e9, -1e9, 1e9};
  const TorpedoActuators<double> limited = boat.model.Limit(wild);
  EXPECT_EQ(limited.rpm, 1525.0);
  EXPECT_NEAR(limited.rudder, -15.0 * kDeg, 1e-15);
  EXPECT_NEAR(limited.stern_plane, 15.0 * kDeg, 1e-15);
  boat.Run(0.1, limited);
  EXPECT_NEAR(boat.actuators.rudder, -15.0 * kDeg * (1.0 - std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(boat.actuators.rpm, 1525.0 * (1.0 - std::exp(-0.1)), 1e-9);
}

TEST(Torpedo, RestsInStillWaterAndRightsItself) {
  Boat boat;
  boat.Run(10.0, {});
  EXPECT_EQ(Norm(boat.state.p_WB), 0.0);
  EXPECT_EQ(Norm(boat.state.v_WB_B), 0.0);
  boat.state = AtAttitude({0.3, -0.2, 1.0});
  boat.Run(120.0, {});
  const Vec3<double> rpy = RpyOf(boat.state.trig);
  EXPECT_NEAR(rpy.x, 0.0, 1e-6);
  EXPECT_NEAR(rpy.y, 0.0, 1e-6);
}

TEST(Torpedo, CurrentMovesTheFrameAndNothingElse) {
  // The same run in a current is the run in still water, carried along.
  Boat still, moved;
  moved.v_WC = {0.4, -0.3, 0.0};
  moved.state.v_WB_B = moved.v_WC;  // at rest in the water
  const TorpedoActuators<double> command{1300.0, 4.0 * kDeg, -2.0 * kDeg};
  still.Run(40.0, command);
  moved.Run(40.0, command);
  EXPECT_LT(Norm(moved.state.p_WB - (still.state.p_WB + moved.v_WC * 40.0)), 1e-6);
  EXPECT_LT(Norm(moved.state.v_WB - (still.state.v_WB + moved.v_WC)), 1e-7);
}

TEST(Torpedo, LosesEnergyWithoutPropulsion) {
  // Hull, fins and damping brake. The terms of C do almost no work here.
  Boat boat;
  boat.state.v_WB_B = {2.0, 0.1, -0.1};
  boat.state.w_WB_B = {0.1, 0.05, 0.1};
  double before = 1e9;
  for (int k = 0; k < 60; ++k) {
    const auto& M = boat.model.inertia();
    const Vec3<double>&v = boat.state.v_WB_B, &w = boat.state.w_WB_B;
    const double energy = 0.5 * (M[0] * v.x * v.x + M[1] * v.y * v.y + M[2] * v.z * v.z +
                                 M[3] * w.x * w.x + M[4] * w.y * w.y + M[5] * w.z * w.z);
    EXPECT_LT(energy, before * 1.02);
    before = energy;
    boat.Run(1.0, {});
  }
  EXPECT_LT(before, 10.0);
}

TEST(Torpedo, StaysFiniteUnderAnyCommand) {
  for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicit}) {
    VehicleConfig config;
    config.integrator = integrator;
    Boat boat(config);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    boat.v_WC = {0.5, 0.5, 0.1};
    for (int k = 0; k < 2000; ++k) {
      boat.w.moment = RandomVector(&random, 2.0);
      boat.Run(0.5, boat.model.Limit(TorpedoActuators<double>{
                        2e3 * uniform(random), 0.4 * uniform(random), 0.4 * uniform(random)}));
    }
    EXPECT_TRUE(Finite(boat.state.p_WB) && Finite(boat.state.v_WB_B) && Finite(boat.state.w_WB_B));
    EXPECT_LT(Norm(boat.state.v_WB_B), 10.0);
  }
}

TEST(Torpedo, RefusesAHullWiderThanLong) {
  VehicleConfig config;
  config.torpedo.diameter_m = 2.0;
  EXPECT_THROW(Torpedo{config}, UserError);
}

}  // namespace
}  // namespace stg::dynamics

#include "auv_dynamics/autopilot/autopilot.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "auv_dynamics/vehicle/torpedo.hpp"
#include "physics.hpp"

namespace stg::dynamics {
namespace {

constexpr double kInRad = kPi / 180.0;
constexpr double kPhysics_s = 0.05;

/// Commands 0.2 s apart.
AutopilotConfig Slow() {
  AutopilotConfig config;
  config.period_steps = 4;
  return config;
}

/// A torpedo under its autopilot, from rest at the origin, bow to the east.
class Helmsman {
 public:
  explicit Helmsman(const AutopilotConfig& config = Slow(), const Vec3<double>& v_WC = {})
      : config_(config),
        model_(vehicle_.torpedo),
        autopilot_(Autopilots().Make("torpedo", vehicle_, config)),
        memory_(static_cast<size_t>(autopilot_->state_size()), 0.0),
        v_WC_(v_WC) {
    state_ = AtAttitude({});
    state_.v_WB_B = v_WC;  // bow to the east: at rest in the water
  }

  NavState nav() const {
    NavState nav;
    nav.p_WB = state_.p_WB;
    std::copy(state_.q_WB, state_.q_WB + 4, nav.q_WB);
    nav.v_WB_B = state_.v_WB_B;
    nav.w_WB_B = state_.w_WB_B;
    return nav;
  }
  void Steer(const Vec3<double>& v_des_W) {
    const double dt = config_.period_steps * kPhysics_s;
    double c[3];
    autopilot_->Steer(v_des_W, nav(), dt, memory_.data(), c);
    command_ = {c[0], c[1], c[2]};
    for (int k = 0; k < config_.period_steps; ++k) {
      Integrate(model_, vehicle_, command_, Wrench<double>(), v_WC_, kPhysics_s, &state_,
                &actuators_);
    }
    time_s_ += dt;
  }
  void Hold(const Vec3<double>& v_des_W, double seconds) {
    for (const double end = time_s_ + seconds - 1e-9; time_s_ < end;) Steer(v_des_W);
  }
  double time_s() const { return time_s_; }
  double depth() const { return -state_.p_WB.z; }
  double heading_deg() const { return RpyOf(state_.trig).z / kInRad; }
  double course_deg() const { return std::atan2(state_.v_WB.y, state_.v_WB.x) / kInRad; }
  double speed() const { return std::hypot(state_.v_WB.x, state_.v_WB.y); }
  const VehicleState<double>& state() const { return state_; }
  const TorpedoActuators<double>& command() const { return command_; }
  const TorpedoActuators<double>& actuators() const { return actuators_; }

 private:
  AutopilotConfig config_;
  VehicleConfig vehicle_;
  TorpedoModel model_;
  std::unique_ptr<const Autopilot> autopilot_;
  std::vector<double> memory_;
  Vec3<double> v_WC_;
  VehicleState<double> state_;
  TorpedoActuators<double> actuators_, command_;
  double time_s_ = 0.0;
};

Vec3<double> Towards(double course_deg, double speed, double climb) {
  return {speed * std::cos(course_deg * kInRad), speed * std::sin(course_deg * kInRad), climb};
}

TEST(Autopilot, BettersThePublishedRunToThirtyMetresAndFiftyDegrees) {
  // The autopilot of the public model is 26.20, 29.70, 30.04 m deep at 100, 200, 300 s, and never
  // deeper than 30.05 m. Its heading is 17.94, 43.09, 49.64 degrees at 20, 50, 100 s. A turn to the
  // other side must be as good.
  for (const double side : {1.0, -1.0}) {
    Helmsman h;
    double deepest = 0.0, depth_100 = 0.0, heading_20 = 0.0, heading_50 = 0.0, worst_late = 0.0;
    while (h.time_s() < 300.0 - 1e-9) {
      const double down = std::clamp(0.08 * (30.0 - h.depth()), -0.5, 0.5);
      h.Steer(Towards(side * 50.0, 2.5, -down));
      deepest = std::max(deepest, h.depth());
      const double t = h.time_s();
      if (std::abs(t - 20.0) < 1e-6) heading_20 = side * h.heading_deg();
      if (std::abs(t - 50.0) < 1e-6) heading_50 = side * h.heading_deg();
      if (std::abs(t - 100.0) < 1e-6) depth_100 = h.depth();
      if (t > 100.0) worst_late = std::max(worst_late, std::abs(side * h.heading_deg() - 50.0));
    }
    std::printf(
        "side %.0f: depth %.3f at 100 s, %.3f at the end, at most %.3f m; heading %.2f, %.2f, "
        "later off by %.3f deg; speed %.4f\n",
        side, depth_100, h.depth(), deepest, heading_20, heading_50, worst_late, h.speed());
    EXPECT_LT(deepest, 30.05);
    EXPECT_GT(depth_100, 26.2);
    EXPECT_NEAR(h.depth(), 30.0, 0.04);
    EXPECT_GT(heading_20, 17.94);
    EXPECT_GT(heading_50, 43.09);
    EXPECT_LT(worst_late, 1.0);
    EXPECT_NEAR(h.speed(), 2.5, 0.01);
  }
}

TEST(Autopilot, FollowsSpeedCourseAndClimbRateOverItsRange) {
  for (const double speed : {0.8, 1.2, 1.8, 2.3}) {
    for (const double course_deg : {-170.0, -60.0, 0.0, 20.0, 120.0, 179.0}) {
      Helmsman h;
      h.Hold(Towards(course_deg, speed, 0.0), 120.0);
      const double climb = 0.04 * speed;
      h.Hold(Towards(course_deg, speed, climb), 60.0);
      EXPECT_NEAR(h.speed(), speed, 0.02) << speed << " " << course_deg;
      EXPECT_NEAR(std::remainder(h.course_deg() - course_deg, 360.0), 0.0, 0.5)
          << speed << " " << course_deg;
      EXPECT_NEAR(h.state().v_WB.z, climb, 0.01) << speed << " " << course_deg;
    }
  }
}

TEST(Autopilot, TurnsWithLittleOvershootAndSettles) {
  for (const double course_deg : {30.0, 90.0, 170.0}) {
    for (const double speed : {0.8, 1.5, 2.3}) {
      Helmsman h;
      h.Hold(Towards(0.0, speed, 0.0), 30.0);
      double most = 0.0, settled_s = 0.0;
      while (h.time_s() < 200.0) {
        h.Steer(Towards(course_deg, speed, 0.0));
        most = std::max(most, h.course_deg());
        if (std::abs(h.course_deg() - course_deg) > 1.0) settled_s = h.time_s();
      }
      EXPECT_LT(most, course_deg + 6.0) << speed;
      // The fins turn it at 5 deg/s, and at 2 deg/s if its speed is 0.8 m/s.
      EXPECT_LT(settled_s - 30.0, course_deg / (speed < 1.0 ? 2.0 : 5.0) + 40.0) << speed;
    }
  }
}

TEST(Autopilot, HoldsCourseOverGroundAcrossACurrent) {
  for (const double set_deg : {90.0, 170.0, 0.0, -45.0}) {
    Helmsman h(Slow(), Towards(set_deg, 0.5, 0.0));
    h.Hold(Towards(50.0, 1.5, 0.0), 200.0);
    EXPECT_NEAR(h.course_deg(), 50.0, 0.5) << set_deg;
    EXPECT_NEAR(h.speed(), 1.5, 0.03) << set_deg;
  }
}

TEST(Autopilot, KeepsSteerageWayWhateverIsAsked) {
  Helmsman h;
  h.Hold({}, 60.0);
  EXPECT_NEAR(h.state().v_WB_B.x, 0.8, 0.02);
  EXPECT_NEAR(h.heading_deg(), 0.0, 0.5);
  // It also keeps steerage way when the current alone carries it over ground fast enough.
  Helmsman carried(Slow(), {1.5, 0.0, 0.0});
  carried.Hold(Towards(0.0, 1.0, 0.0), 120.0);
  EXPECT_GT(carried.state().v_WB_B.x - 1.5, 0.75);
}

TEST(Autopilot, RecoversAtOnceFromWhatItCannotDo) {
  // Two minutes of commands that it cannot follow must leave nothing wound up.
  Helmsman h;
  h.Hold(Towards(0.0, 9.0, -5.0), 120.0);
  EXPECT_LE(h.command().rpm, 1525.0);
  const double depth = h.depth();
  h.Hold(Towards(0.0, 1.5, 0.0), 15.0);
  EXPECT_LT(h.depth() - depth, 12.0);
  EXPECT_NEAR(h.state().v_WB.z, 0.0, 0.06);
  EXPECT_NEAR(h.speed(), 1.5, 0.1);
}

TEST(Autopilot, WorksFromFiftyMillisecondsToHalfASecond) {
  for (const int steps : {1, 2, 4, 10}) {
    AutopilotConfig config;
    config.period_steps = steps;
    Helmsman h(config);
    h.Hold(Towards(60.0, 2.0, -0.3), 120.0);
    EXPECT_NEAR(h.course_deg(), 60.0, 0.5) << steps;
    EXPECT_NEAR(h.state().v_WB.z, -0.3, 0.01) << steps;
    EXPECT_LT(std::abs(h.actuators().rudder), 0.02) << steps;
  }
}

TEST(Autopilot, OfDoublesEqualsThatOfPacksBitForBit) {
  std::mt19937_64 random(11);
  VehicleConfig vehicle;
  for (const std::string& model : Autopilots().Names()) {
    const auto autopilot = Autopilots().Make(model, vehicle, AutopilotConfig());
    const auto size = static_cast<size_t>(autopilot->state_size());
    const size_t outputs = Vehicles().Make(model, vehicle)->actuators().size();
    std::vector<Pack> states(size, Pack(0.0));
    std::vector<std::vector<double>> alone(static_cast<size_t>(kLanes),
                                           std::vector<double>(size, 0.0));
    for (int n = 0; n < 300; ++n) {
      Navigation<Pack> nav;
      Vec3<Pack> wanted;
      std::vector<Navigation<double>> navs(static_cast<size_t>(kLanes));
      for (int l = 0; l < kLanes; ++l) {
        NavState& one = navs[static_cast<size_t>(l)];
        one.v_WB_B = RandomVector(&random, 2.0);
        one.w_WB_B = RandomVector(&random, 0.3);
        QuaternionOf(RandomVector(&random, 0.8), &one.q_WB);
        SetLane(&nav.v_WB_B, l, one.v_WB_B);
        SetLane(&nav.w_WB_B, l, one.w_WB_B);
        for (int k = 0; k < 4; ++k) SetLane(&nav.q_WB[k], l, one.q_WB[k]);
        SetLane(&wanted, l, n % 10 == 0 ? Vec3<double>() : RandomVector(&random, 2.5));
      }
      std::vector<Pack> packs(outputs);
      autopilot->Steer(wanted, nav, 0.2, states.data(), packs.data());
      for (int l = 0; l < kLanes; ++l) {
        const auto u = static_cast<size_t>(l);
        std::vector<double> command(outputs);
        autopilot->Steer(Lane(wanted, l), navs[u], 0.2, alone[u].data(), command.data());
        for (size_t k = 0; k < outputs; ++k) ASSERT_EQ(Lane(packs[k], l), command[k]) << model;
        for (size_t k = 0; k < size; ++k) ASSERT_EQ(Lane(states[k], l), alone[u][k]) << model;
      }
    }
  }
}

TEST(Autopilot, EveryOneSteersAVehicleThatIsRegistered) {
  for (const std::string& name : Autopilots().Names()) EXPECT_TRUE(Vehicles().Has(name)) << name;
  EXPECT_FALSE(Autopilots().Has("fully_actuated"));
}

}  // namespace
}  // namespace stg::dynamics

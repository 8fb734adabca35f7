#include <gtest/gtest.h>

#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "auv_dynamics/vehicle/shaft_power.hpp"
#include "stg_env/task/task.hpp"

/// How a task judges AUVs in open water, beside the paper's terms.
namespace stg::task {
namespace {

JudgeConfig Sea(int agents, int targets = 1) {
  JudgeConfig s;
  s.run.agents = agents;
  s.world.target.count = targets;
  s.world.sea.open = true;
  s.world.vehicle.radius_m = 2.5;
  s.run.time.dt_s = 1.0;
  s.run.time.episode_steps = 100;
  s.run.time.tail_steps = 10;
  s.agent.task.desired_distance_m = 90.0;
  s.agent.task.lost_distance_m = 600.0;
  s.agent.task.lost_error_m = 100.0;
  s.reward.band_m = {60.0, 120.0};
  s.reward.separation_distance_m = 20.0;
  return s;
}

/// A swarm that a test sets by hand.
struct Swarm {
  explicit Swarm(const JudgeConfig& s)
      : vehicles(static_cast<std::size_t>(s.run.agents)),
        targets(static_cast<std::size_t>(s.world.target.count)),
        separations(s.run.agents, 5.0),
        efforts(vehicles.size()),
        field(vehicles.size()) {
    for (Effort<double>& e : efforts) e.fill(0.0);
    for (FieldState<double>& f : field) f.known = 1.0;
  }
  SwarmState<double> State() {
    separations.Measure(vehicles);
    return {vehicles, targets, separations, efforts, efforts, 0.0, &field};
  }

  std::vector<dynamics::VehicleState<double>> vehicles;
  std::vector<dynamics::TargetState<double>> targets;
  dynamics::Separations<double> separations;
  Efforts<double> efforts;
  std::vector<FieldState<double>> field;
};

TEST(Spread, IsOneMinusTheLengthOfTheMeanBearing) {
  const JudgeConfig s = Sea(4);
  Swarm swarm(s);
  swarm.targets[0].p_WT = {5.0, -3.0, -40.0};
  const auto stand = [&](std::initializer_list<double> degrees) {
    std::size_t i = 0;
    for (const double d : degrees) {
      const double a = d * kPi / 180.0, range = 50.0 + 20.0 * static_cast<double>(i);
      swarm.vehicles[i++].p_WB =
          swarm.targets[0].p_WT + Vec3<double>{range * std::cos(a), range * std::sin(a), 11.0};
    }
    return Spread(swarm.State(), 0);
  };
  EXPECT_NEAR(stand({10.0, 100.0, 190.0, 280.0}), 1.0, 1e-12);
  EXPECT_NEAR(stand({33.0, 33.0, 33.0, 33.0}), 0.0, 1e-12);
  EXPECT_NEAR(stand({0.0, 0.0, 90.0, 90.0}), 1.0 - std::sqrt(0.5), 1e-12);
}

TEST(NormalisedSquare, IsThatOfTheInverseCovariance) {
  // P = L L^T with a known L, so r^T P^-1 r = |L^-1 r|^2 by forward substitution.
  for (std::uint32_t k = 0; k < 200; ++k) {
    Random random(1, Stream::kReset, 0, 0, k);
    const double a = random.Uniform(0.5, 9.0), b = random.Uniform(-5.0, 5.0),
                 c = random.Uniform(0.5, 9.0), d = random.Uniform(-5.0, 5.0),
                 e = random.Uniform(-5.0, 5.0), f = random.Uniform(0.5, 9.0);
    const double P[6] = {a * a, a * b, a * d, b * b + c * c, b * d + c * e, d * d + e * e + f * f};
    const Vec3<double> r{random.Uniform(-9.0, 9.0), random.Uniform(-9.0, 9.0),
                         random.Uniform(-9.0, 9.0)};
    const double x = r.x / a, y = (r.y - b * x) / c, z = (r.z - d * x - e * y) / f;
    const double expected = x * x + y * y + z * z;
    EXPECT_NEAR(NormalisedSquare(r, P), expected, 1e-8 * (1.0 + expected));
  }
  const double none[6] = {};
  EXPECT_EQ(NormalisedSquare(Vec3<double>{1.0, 2.0, 3.0}, none), 0.0);
}

TEST(FieldMetrics, CountErrorsSpellsOfLossAndNearness) {
  const JudgeConfig s = Sea(2);
  Task<double> task(s);
  Swarm swarm(s);
  swarm.targets[0].p_WT = {0.0, 0.0, -40.0};
  swarm.vehicles[0].p_WB = {90.0, 0.0, -40.0};
  swarm.vehicles[1].p_WB = {-130.0, 0.0, -40.0};
  for (FieldState<double>& f : swarm.field) {
    f.p_WT = {3.0, 0.0, -36.0};  // the estimate is wrong by 5 m
    for (const int k : {0, 3, 5}) f.covariance[k] = 4.0;
    f.age_s = 2.0;
    f.altitude_m = 80.0;
    f.clearance_m = 300.0;
  }
  task.Start(true, swarm.State(), 100.0);
  // AUV 0 has a wrong estimate in decisions 3 to 7 and 10 to 11. AUV 1 has none in the last one.
  for (int k = 1; k <= 20; ++k) {
    const bool astray = (k >= 3 && k <= 7) || (k >= 10 && k <= 11);
    swarm.field[0].p_WT.x = astray ? 103.0 : 3.0;
    swarm.field[1].known = k == 20 ? 0.0 : 1.0;
    swarm.field[0].altitude_m = k == 5 ? 7.0 : 80.0;
    swarm.field[1].clearance_m = k == 6 ? 11.0 : 300.0;
    swarm.field[1].collisions = k < 8 ? 0.0 : 2.0;
    swarm.field[0].groundings = k < 9 ? 0.0 : 1.0;
    swarm.field[0].received = swarm.field[1].received = 3.0 * k;
    swarm.field[0].missed = swarm.field[1].missed = k;
    swarm.field[0].modem_energy_j = 10.0 * k;
    swarm.field[1].modem_energy_j = 30.0 * k;
    swarm.vehicles[1].p_WB.x = k > 15 ? 109.0 : -130.0;  // 19 m from the other
    for (std::size_t i = 0; i < 2; ++i) {
      swarm.field[i].r_BT_W = swarm.field[i].p_WT - swarm.vehicles[i].p_WB;
    }
    task.Step(swarm.State());
    EXPECT_EQ(task.tracking(0).lost, astray ? 1.0 : 0.0);
    EXPECT_EQ(task.tracking(1).lost, k == 20 ? 1.0 : 0.0);
  }
  const EpisodeMetrics metrics = task.Metrics(0);
  ASSERT_TRUE(metrics.field.has_value());
  const FieldMetrics& m = *metrics.field;
  const double known = 39.0, far = 103.0 * 103.0 + 16.0;
  EXPECT_NEAR(m.estimate_rmse, std::sqrt((7.0 * far + 32.0 * 25.0) / known), 1e-9);
  EXPECT_NEAR(m.nees, (7.0 * far + 32.0 * 25.0) / 4.0 / known, 1e-9);
  EXPECT_NEAR(m.estimate_known, known / 40.0, 1e-12);
  EXPECT_NEAR(m.information_age, 2.0, 1e-12);
  EXPECT_NEAR(m.band_share, 25.0 / 40.0, 1e-12);
  EXPECT_NEAR(m.worst_band_share, 5.0 / 20.0, 1e-12);
  EXPECT_NEAR(m.time_lost, 8.0 / 2.0, 1e-12);
  EXPECT_NEAR(m.time_to_reacquire, (5.0 + 2.0) / 2.0, 1e-12) << "the spell that runs is none yet";
  EXPECT_NEAR(m.losses, 3.0 / 2.0, 1e-12);
  EXPECT_NEAR(m.spread, (15.0 * 1.0 + 5.0 * 0.0) / 20.0, 1e-12);
  EXPECT_NEAR(m.near_pairs, 5.0 / 20.0, 1e-12);
  EXPECT_EQ(m.min_altitude, 7.0);
  EXPECT_EQ(m.min_clearance, 11.0);
  EXPECT_EQ(m.groundings, 1.0);
  EXPECT_EQ(m.collisions, 2.0);
  EXPECT_EQ(m.packets, 60.0);
  EXPECT_NEAR(m.packet_loss, 0.25, 1e-12);
  EXPECT_EQ(m.modem_energy, 400.0);
  // A second episode counts from zero.
  for (FieldState<double>& f : swarm.field) f = FieldState<double>();
  task.Start(true, swarm.State(), 100.0);
  task.Step(swarm.State());
  EXPECT_EQ(task.Metrics(0).field->groundings, 0.0);
  EXPECT_EQ(task.Metrics(0).field->losses, 1.0);
}

TEST(FieldMetrics, CountTheWorkOfPropellers) {
  JudgeConfig s = Sea(3);
  s.world.vehicle.models = {"torpedo", "torpedo", "kinematic"};
  Task<double> task(s);
  Swarm swarm(s);
  swarm.efforts[0][0] = 0.5;
  swarm.efforts[1][0] = -0.25;
  swarm.efforts[2][0] = 1.0;  // this vehicle has no propeller
  swarm.vehicles[0].v_WB = {0.0, 1.2, 0.0};
  task.Start(true, swarm.State(), 100.0);
  for (int k = 0; k < 10; ++k) task.Step(swarm.State());
  const dynamics::TorpedoConfig& torpedo = s.world.vehicle.torpedo;
  const double power = dynamics::ShaftPower(torpedo, 0.5 * 1525.0, 1.2) +
                       dynamics::ShaftPower(torpedo, -0.25 * 1525.0, 0.0);
  EXPECT_NEAR(task.Metrics(0).field->propulsion_energy, power * 10.0 * s.run.decision_dt_s() / 3.0,
              1e-9);
}

TEST(CriticState, TellsInOpenWaterHowWrongTheEstimateIs) {
  JudgeConfig s = Sea(1);
  s.critic.near_scale_m = 200.0;
  s.critic.far_scale_m = 1000.0;
  Task<double> task(s);
  Swarm swarm(s);
  swarm.targets[0].p_WT = {100.0, 0.0, -40.0};
  swarm.vehicles[0].p_WB = {0.0, 0.0, -40.0};
  FieldState<double>& f = swarm.field[0];
  f.r_BT_W = {150.0, -20.0, 10.0};
  f.covariance[0] = 30.0 * 30.0;
  f.covariance[3] = 40.0 * 40.0;
  f.covariance[5] = 200.0 * 200.0;
  f.age_s = 60.0;
  const auto state = [&] {
    std::vector<double> row;
    task.Start(true, swarm.State(), 100.0);
    task.WriteCriticState(swarm.State(),
                          [&](const double* x, int n) { row.insert(row.end(), x, x + n); });
    return row;
  };
  std::vector<double> row = state();
  ASSERT_EQ(row.size(), static_cast<std::size_t>(CriticStateSize(s.run, s.world)));
  ASSERT_EQ(row.size(), 19U + 7U + 6U);
  EXPECT_NEAR(row[0], 0.1, 1e-12);  // scaled by far_scale_m
  EXPECT_NEAR(row[3], 0.5, 1e-12);  // scaled by near_scale_m
  EXPECT_NEAR(row[15], 10.0 / 200.0, 1e-12) << "d - d*";
  const double expected[] = {1.0, 0.25, -0.1, 0.05, 0.2, 0.5, 0.5};
  for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(row[19 + k], expected[k], 1e-12) << k;
  EXPECT_NEAR(row[26], 0.1, 1e-12) << "the target's place";
  f.known = 0.0;
  row = state();
  for (std::size_t k = 0; k < 7; ++k) EXPECT_EQ(row[19 + k], 0.0) << k;
}

TEST(FieldMetrics, AreNoneInABox) {
  JudgeConfig s = Sea(1);
  Task<double> task(s);
  Swarm swarm(s);
  SwarmState<double> state = swarm.State();
  state.field = nullptr;
  task.Start(true, state, 100.0);
  task.Step(state);
  EXPECT_FALSE(task.Metrics(0).field.has_value());
  EXPECT_EQ(task.Metrics(0).Items().back().first, "reward_separation");
}

TEST(FieldTerms, AreWhatTheirNamesSay) {
  const JudgeConfig s = Sea(1);
  Swarm swarm(s);
  swarm.targets[0].p_WT = {0.0, 0.0, -40.0};
  swarm.vehicles[0].p_WB = {90.0, 0.0, -40.0};
  const auto value = [&](const std::string& name) {
    const SwarmState<double> state = swarm.State();
    const Tracking<double> tracking;
    const Effort<double> none{};
    return RewardTermsByName().Make(name, s)->Evaluate({state, 0, tracking, none, none});
  };
  FieldState<double>& f = swarm.field[0];
  f.altitude_m = 10.0;
  EXPECT_EQ(value("seabed"), 0.0);
  f.altitude_m = 2.5;
  EXPECT_EQ(value("seabed"), -0.75);
  f.altitude_m = -1.0;
  EXPECT_EQ(value("seabed"), -1.0);
  EXPECT_EQ(value("obstacle"), 0.0) << "there is none";
  f.clearance_m = 5.0;
  EXPECT_NEAR(value("obstacle"), -0.8, 1e-12);
  swarm.efforts[0][0] = -0.5;
  EXPECT_EQ(value("energy"), -0.125);
  f.p_WT = {0.0, 30.0, -40.0};
  EXPECT_EQ(value("estimate"), 0.5);
  f.p_WT = {0.0, 9.0, -40.0};
  EXPECT_EQ(value("estimate"), 1.0);
  f.known = 0.0;
  EXPECT_EQ(value("estimate"), 0.0);
  EXPECT_EQ(value("spread"), 0.0) << "one AUV is on one side";
}

TEST(FieldMetrics, AreOfTheOwnFrameAndOfTheWorldApart) {
  // The navigation of the AUV is wrong by 500 m, and its vector to the target by (3, 4, 12). It has
  // not lost the target, although it does not know where in the world both are.
  const JudgeConfig s = Sea(1);
  Task<double> task(s);
  Swarm swarm(s);
  const Vec3<double> off{3.0, 4.0, 12.0}, drift{300.0, 400.0, 0.0};
  swarm.targets[0].p_WT = {10.0, 20.0, -40.0};
  swarm.vehicles[0].p_WB = {100.0, 20.0, -30.0};
  task.Start(true, swarm.State(), 100.0);
  for (int k = 1; k <= 100; ++k) {
    swarm.field[0].r_BT_W = swarm.targets[0].p_WT - swarm.vehicles[0].p_WB + off;
    swarm.field[0].p_WT = swarm.targets[0].p_WT + off + drift;
    // In the tail the error of the vector is twice as large. Before the tail it exceeds 100 m once.
    if (k > 90) swarm.field[0].r_BT_W = swarm.field[0].r_BT_W + off;
    if (k == 50) swarm.field[0].r_BT_W.x += 120.0;
    task.Step(swarm.State());
    EXPECT_EQ(task.tracking(0).lost, k == 50 ? 1.0 : 0.0);
  }
  const EstimateMetrics m = task.Metrics(0).field->estimates;
  EXPECT_NEAR(m.own_rmse, std::sqrt((89.0 * 25.0 + 10.0 * 100.0 + 123.0 * 123.0 + 16.0) / 100.0),
              1e-9);
  EXPECT_NEAR(m.own_rmse_tail, 10.0, 1e-9);
  EXPECT_NEAR(m.own_95, 10.0, 0.5) << "99 of 100 are at most 10 m, 90 of them 5 m";
  EXPECT_NEAR(m.world_rmse, std::hypot(303.0, 404.0), 1e-9);
  EXPECT_NEAR(m.world_rmse_tail, std::hypot(303.0, 404.0), 1e-9);
  EXPECT_NEAR(m.world_95, std::hypot(303.0, 404.0), 0.05 * 505.0);
  EXPECT_NEAR(m.vertical_rmse, 12.0, 1e-9);
  EXPECT_NEAR(m.lost_in_world, 1.0, 1e-12);
}

}  // namespace
}  // namespace stg::task

#include <gtest/gtest.h>

#include <cmath>

#include "stg_env/task/field_totals.hpp"

/// How a task judges a search and the gathering after it. The tests set the swarms by hand.
namespace stg::task {
namespace {

JudgeConfig Sea(int agents) {
  JudgeConfig s;
  s.run.agents = agents;
  s.world.target.count = 1;
  s.world.sea.open = true;
  s.run.time.dt_s = 1.0;
  s.run.time.decision_steps = 1;
  s.reward.band_m = {60.0, 120.0};
  return s;
}

struct Swarm {
  explicit Swarm(int agents)
      : vehicles(static_cast<std::size_t>(agents)),
        targets(1),
        separations(agents, 5.0),
        efforts(vehicles.size()),
        field(vehicles.size()),
        tracking(vehicles.size()) {}

  /// @param degrees bearing of each AUV from the target
  void Stand(std::initializer_list<double> degrees, double distance_m) {
    std::size_t i = 0;
    for (const double d : degrees) {
      const double a = d * kPi / 180.0;
      const Vec3<double> r{-distance_m * std::cos(a), -distance_m * std::sin(a), 0.0};
      tracking[i].r_BT_W = r;
      tracking[i].distance = distance_m;
      field[i].known = 1.0;
      field[i++].r_BT_W = r;
    }
  }
  void AddTo(SearchTotals<double>* totals) {
    totals->Add({vehicles, targets, separations, efforts, efforts, 0.0, &field}, tracking);
  }

  std::vector<dynamics::VehicleState<double>> vehicles;
  std::vector<dynamics::TargetState<double>> targets;
  dynamics::Separations<double> separations;
  Efforts<double> efforts;
  std::vector<FieldState<double>> field;
  std::vector<Tracking<double>> tracking;
};

double InfoSpread(std::initializer_list<double> degrees) {
  const int agents = static_cast<int>(degrees.size());
  SearchTotals<double> totals(Sea(agents));
  Swarm swarm(agents);
  swarm.Stand(degrees, 90.0);
  totals.Start(true);
  swarm.AddTo(&totals);
  return totals.Metrics(0, 1.0).info_spread;
}

TEST(SearchMetrics, TwoOnOneLineSeeOneAxisOnly) {
  EXPECT_NEAR(InfoSpread({20.0, 200.0}), 0.0, 1e-12);
  EXPECT_NEAR(InfoSpread({20.0, 110.0}), 1.0, 1e-12);
  EXPECT_NEAR(InfoSpread({0.0, 120.0, 240.0}), 1.0, 1e-12);
}

TEST(SearchMetrics, FoundAndGatheredAreTheFirstTimes) {
  SearchTotals<double> totals(Sea(2));
  Swarm swarm(2);
  totals.Start(true);
  for (int t = 1; t <= 100; ++t) {
    swarm.Stand({0.0, 90.0}, t < 70 ? 300.0 : 90.0);
    // From 40 s on, the second AUV knows an observation that was made at 30 s.
    swarm.field[0].age_s = t;
    swarm.field[1].age_s = t < 40 ? t : t - 30.0;
    swarm.AddTo(&totals);
  }
  const SearchMetrics m = totals.Metrics(0, 100.0);
  EXPECT_EQ(m.found, 1.0);
  EXPECT_EQ(m.time_to_detect, 40.0);
  EXPECT_EQ(m.time_to_gather, 70.0);
  EXPECT_NEAR(m.followed, 0.31, 1e-12);
}

TEST(SearchMetrics, WithoutAnObservationNothingIsFoundOrFollowed) {
  SearchTotals<double> totals(Sea(2));
  Swarm swarm(2);
  totals.Start(true);
  for (int t = 1; t <= 50; ++t) {
    swarm.Stand({0.0, 90.0}, 90.0);
    for (FieldState<double>& f : swarm.field) {
      f.age_s = t;
      f.r_BT_W.x += 25.0;  // the error exceeds that of a good estimate
    }
    swarm.AddTo(&totals);
  }
  const SearchMetrics m = totals.Metrics(0, 50.0);
  EXPECT_EQ(m.found, 0.0);
  EXPECT_EQ(m.time_to_detect, 50.0);
  EXPECT_EQ(m.followed, 0.0);
}

TEST(SearchMetrics, TheErrorOfATargetIsThatOfItsNearestAuv) {
  JudgeConfig scenario = Sea(2);
  scenario.world.target.count = 2;
  scenario.agent.task.assignment = agent::Assignment::kFree;
  SearchTotals<double> totals(scenario);
  Swarm swarm(2);
  swarm.Stand({0.0, 90.0}, 90.0);
  swarm.targets.resize(2);
  swarm.targets[1].p_WT = {1000.0, 0.0, -40.0};
  swarm.vehicles[0].p_WB = {100.0, 0.0, 0.0};
  swarm.vehicles[1].p_WB = {900.0, 0.0, 0.0};
  Following<double> following(2, 2);
  following.known = {1.0, 1.0, 1.0, 1.0};
  // Rows are AUVs. The depth of the first one's estimate is wrong, too, which does not count.
  following.p_WT = {{3.0, 4.0, -25.0}, {500.0, 0.0, 0.0}, {-60.0, 0.0, 0.0}, {1000.0, 15.0, -40.0}};
  const auto add = [&] {
    totals.Add({swarm.vehicles, swarm.targets, swarm.separations, swarm.efforts, swarm.efforts, 0.0,
                &swarm.field, &following},
               swarm.tracking);
  };
  totals.Start(true);
  add();
  EXPECT_DOUBLE_EQ(*totals.Metrics(0, 1.0).choices->nearest_error, (5.0 + 15.0) / 2.0);
  following.known[3] = 0.0;  // the AUV nearest to the second target has no estimate of it
  add();
  EXPECT_DOUBLE_EQ(*totals.Metrics(0, 2.0).choices->nearest_error, (5.0 + 15.0 + 5.0) / 3.0);
  swarm.field[0].present = 0.0;  // the other AUV is the nearest one now
  add();
  EXPECT_DOUBLE_EQ(*totals.Metrics(0, 3.0).choices->nearest_error, (25.0 + 60.0) / 4.0);
}

TEST(SearchMetrics, NetSpeedIsOneOnAStraightWayAndLessOnACircle) {
  for (const bool straight : {true, false}) {
    SearchTotals<double> totals(Sea(1));
    Swarm swarm(1);
    swarm.Stand({0.0}, 90.0);
    totals.Start(true);
    // Each window of 600 s is a quarter of a circle: chord / arc is sin(pi / 4) / (pi / 4).
    for (int t = 0; t <= 1300; ++t) {
      const double a = 0.5 * kPi * t / 600.0;
      swarm.targets[0].p_WT = straight
                                  ? Vec3<double>{2.0 * t, 0.0, 0.0}
                                  : Vec3<double>{500.0 * std::cos(a), 500.0 * std::sin(a), 0.0};
      swarm.AddTo(&totals);
    }
    const double expected = straight ? 1.0 : std::sin(0.25 * kPi) / (0.25 * kPi);
    EXPECT_NEAR(totals.Metrics(0, 1301.0).target_net_speed, expected, 1e-5);
  }
}

}  // namespace
}  // namespace stg::task

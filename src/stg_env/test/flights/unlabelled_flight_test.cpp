#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_env/env/decide.hpp"
#include "stg_env/env/evaluation.hpp"

/// Flights in which detections do not say which target they are of.
namespace stg::env {
namespace {

Scenario Unlabelled(Scenario s) {
  config::Override(&s, {"sensing.labelled=false"});
  return s;
}

void FlyAssign(TestEnv* env, int steps) {
  const agent::Decider decider = agent::MakeDecider("assign", env->scenario().model());
  std::vector<double> a(static_cast<std::size_t>(env->envs() * env->agents() * env->action_size()));
  for (int k = 0; k < steps; ++k) {
    Decide(decider, *env, env->memory.observations.data(), a.data());
    env->VectorEnv::Step(a.data(), env->memory.arrays());
  }
}

TEST(UnlabelledFlight, TheJudgeMeasuresTheTargetOfTheEstimateThatAnAuvFollows) {
  TestEnv env(Short(Unlabelled(Shipped("many8")), 200));
  env.Reset();
  FlyAssign(&env, 150);
  int near = 0;
  for (int e = 0; e < env.envs(); ++e) {
    for (int i = 0; i < env.agents(); ++i) {
      const int target = env.followed(e, i);
      const Vec3<double> p_WT = env.target(e, target).p_WT;
      EXPECT_DOUBLE_EQ(env.tracking(e, i).distance, Norm(p_WT - env.vehicle(e, i).p_WB));
      // A good estimate is judged by the target that it is close to.
      const agent::TargetBelief belief = env.agent(e, i).belief();
      for (int k = 0; k < 3; ++k) {
        const Vec3<double> error = belief.p_WT - env.target(e, k).p_WT;
        if (std::hypot(error.x, error.y) > 20.0) continue;
        EXPECT_EQ(target, k);
        ++near;
      }
    }
  }
  EXPECT_GT(near, 0);
}

TEST(UnlabelledFlight, TheOrderOfEstimatesHasNoEffectOnTheScores) {
  const std::vector<dynamics::TargetState<double>> targets = [] {
    std::vector<dynamics::TargetState<double>> t(3);
    t[0].p_WT = {0.0, 0.0, -40.0};
    t[1].p_WT = {300.0, 0.0, -40.0};
    t[2].p_WT = {0.0, 300.0, -40.0};
    return t;
  }();
  std::vector<int> order{0, 1, 2};
  do {
    // Estimate k is of target order[k], with an error of 10 m.
    task::Following<double> f(1, 3);
    for (std::size_t k = 0; k < 3; ++k) {
      f.known[k] = 1.0;
      f.p_WT[k] = targets[static_cast<std::size_t>(order[k])].p_WT + Vec3<double>{10.0, 0.0, 15.0};
    }
    for (std::size_t k = 0; k < 3; ++k) {
      f.target[0] = static_cast<double>(k);
      f.Match(0, targets);
      EXPECT_EQ(f.target[0], order[k]);
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(UnlabelledFlight, FollowsAlmostAsWellAsWithLabelsWhereTargetsAreFarApart) {
  const auto known = [](const Scenario& s) {
    TestEnv env(Short(s, 200));
    env.Reset();
    FlyAssign(&env, 150);
    int good = 0;
    for (int i = 0; i < env.agents(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const Vec3<double> error = env.agent(0, i).belief(k).p_WT - env.target(0, k).p_WT;
        good += std::hypot(error.x, error.y) < 100.0 ? 1 : 0;
      }
    }
    return good;
  };
  EXPECT_GE(known(Unlabelled(Shipped("many8"))), known(Shipped("many8")) - 2);
}

/// The paths of five targets cross often here. If every choice of a detection counted fully, the
/// mean NEES of these flights would be 5.8 and the error 69 m.
TEST(UnlabelledFlight, EstimatesStayConsistentWhereTargetsMeet) {
  constexpr int kFlights = 8;
  const Scenario s = Shipped("utracking", "unlabelled");
  const auto flights = Evaluate(EnvFactory(s), agent::MakeDecider("assign", s.model()),
                                {kFlights, 500, kMixBlock}, nullptr);
  const task::MetricSummary m = task::Summarise(flights);
  std::printf("NEES %.2f, error %.1f m\n", m.Mean("nees"), m.Mean("own_rmse"));
  EXPECT_LT(m.Mean("nees"), 3.0);
  EXPECT_LT(m.Mean("own_rmse"), 50.0);
}

TEST(UnlabelledFlight, NeedsEstimatesOfAllTargetsByMeasurements) {
  EXPECT_THROW(Unlabelled(Shipped("field")).ValidateOrThrow(), UserError);
  EXPECT_NO_THROW(Unlabelled(Shipped("many8")).ValidateOrThrow());
  Scenario s = Unlabelled(Shipped("many8"));
  config::Override(&s, {"sensing.ranging=ping"});
  EXPECT_THROW(s.ValidateOrThrow(), UserError) << "a transponder says which one it is";
}

}  // namespace
}  // namespace stg::env

#include <gtest/gtest.h>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_env/env/decide.hpp"

/// Flights in which AUVs choose their targets freely, and in which AUVs leave and join.
namespace stg::env {
namespace {

Scenario With(Scenario s, const std::vector<std::string>& overrides) {
  config::Override(&s, overrides);
  return s;
}

void Fly(TestEnv* env, const char* law, int steps) {
  const agent::Decider decider = agent::MakeDecider(law, env->scenario().model());
  std::vector<double> a(static_cast<std::size_t>(env->envs() * env->agents() * env->action_size()));
  for (int k = 0; k < steps; ++k) {
    Decide(decider, *env, env->memory.observations.data(), a.data());
    env->VectorEnv::Step(a.data(), env->memory.arrays());
  }
}

TEST(FreeFlight, TheJudgeMeasuresTheTargetThatAnAuvFollows) {
  TestEnv env(Short(Shipped("many8"), 200));
  env.Reset();
  Fly(&env, "assign", 100);
  int changed = 0;
  for (int e = 0; e < env.envs(); ++e) {
    for (int i = 0; i < env.agents(); ++i) {
      const int target = env.followed(e, i);
      EXPECT_EQ(target, env.agent(e, i).target());
      changed += target != i % 3 ? 1 : 0;
      const double d = Norm(env.target(e, target).p_WT - env.vehicle(e, i).p_WB);
      EXPECT_DOUBLE_EQ(env.tracking(e, i).distance, d);
    }
  }
  EXPECT_GT(changed, 0) << "somebody chooses";
}

TEST(FreeFlight, WhoDoesNotChooseFollowsByNumberAndKnowsAllTargets) {
  TestEnv env(Short(Shipped("many8"), 200));
  env.Reset();
  Fly(&env, "encircle", 100);
  for (int i = 0; i < env.agents(); ++i) {
    EXPECT_EQ(env.followed(0, i), i % 3);
    EXPECT_EQ(env.agent(0, i).beliefs(), 3);
    EXPECT_TRUE(env.agent(0, i).belief(2).started);
  }
}

TEST(FreeFlight, SharedMeasurementsReachWhoSeesNothing) {
  // An AUV that cannot range a target knows only what the others tell about it.
  TestEnv env(Short(Shipped("many8"), 400));
  env.Reset();
  Fly(&env, "assign", 300);
  int sent = 0;
  for (int i = 0; i < env.agents(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double d = Norm(env.target(0, k).p_WT - env.vehicle(0, i).p_WB);
      sent += d > 900.0 && env.agent(0, i).belief(k).observed ? 1 : 0;
    }
  }
  EXPECT_GT(sent, 0);
}

TEST(Members, WhoHasLeftIsSilentAndUnpaidAndComesBackKnowingNothing) {
  const Scenario s =
      With(Short(Shipped("field"), 400), {"fleet.leave=[[20, 1]]", "fleet.join=[[220, 1]]"});
  TestEnv env(s);
  env.Reset();
  Fly(&env, "encircle", 15);
  EXPECT_TRUE(env.present(0, 1));
  EXPECT_TRUE(env.agent(0, 0).neighbours().knows(1));
  Fly(&env, "encircle", 200);
  EXPECT_FALSE(env.present(0, 1));
  EXPECT_FALSE(env.agent(0, 0).neighbours().knows(1)) << "forgotten by its silence alone";
  EXPECT_EQ(env.terms(0, 1).total, 0.0);
  Fly(&env, "encircle", 5);
  EXPECT_TRUE(env.present(0, 1));
  EXPECT_FALSE(env.agent(0, 1).belief().started);
  Fly(&env, "encircle", 60);
  EXPECT_TRUE(env.agent(0, 0).neighbours().knows(1));
  EXPECT_TRUE(env.agent(0, 1).belief().started) << "from the others' packets";
}

TEST(Members, TheMeanRewardIsOfThoseThatAreThere) {
  TestEnv env(With(Short(Shipped("field"), 60), {"fleet.leave=[[0, 2], [0, 3]]"}));
  env.Reset();
  Fly(&env, "encircle", 10);
  EXPECT_NEAR(env.memory.team_rewards[0], 0.5 * (env.terms(0, 0).total + env.terms(0, 1).total),
              1e-6);
}

TEST(FreeFlight, TruthKeepsNoBeliefsToChooseAmong) {
  EXPECT_THROW(With(Shipped("many8"), {"mode=truth"}).ValidateOrThrow(), UserError);
  EXPECT_THROW(With(Shipped("field"), {"fleet.leave=[[0, 4]]"}).ValidateOrThrow(), UserError);
  EXPECT_THROW(With(Shipped("field"), {"fleet.join=[[9, 1]]"}).ValidateOrThrow(), UserError);
}

TEST(FreeFlight, PacketsOfAgentsThatLocateEachOtherHaveNoRoomForIt) {
  EXPECT_NO_THROW(Shipped("deep").ValidateOrThrow());
  EXPECT_THROW(With(Shipped("deep"), {"task.assignment=free"}).ValidateOrThrow(), UserError);
  EXPECT_NO_THROW(With(Shipped("deep"), {"fleet.leave=[[20, 1]]"}).ValidateOrThrow());
}

}  // namespace
}  // namespace stg::env

// Flights in the environment with vehicles that autopilots steer.

#include <gtest/gtest.h>

#include <cmath>

#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_env/env/decide.hpp"

namespace stg::env {
namespace {

Scenario Torpedoes(const std::vector<std::string>& overrides = {}) {
  return LoadNamedScenario(STG_SCENARIO_FOLDER, STG_SCENARIO_FOLDER "/../test/torpedoes.yaml",
                           "nominal", overrides);
}

VectorEnvOptions Few(int envs, std::uint64_t seed) {
  VectorEnvOptions o;
  o.envs = envs;
  o.seed = seed;
  return o;
}

TEST(SteeredEnv, PursuersReachTheirTargetAndKeepGoing) {
  for (const char* model : {"vehicle.model=torpedo", "vehicle.model=kinematic"}) {
    TestEnv env(Torpedoes({model, "time.episode_steps=400", "current.velocity_mps=[0,0,0]",
                           "current.layer_east_mps=[0,0,0,0]", "current.tide_mps=[0,0]"}),
                Few(8, 3));
    env.Reset();
    const agent::Decider pursuit = agent::MakeDecider("pursuit_separated", env.scenario(0).model());
    std::vector<double> actions(
        static_cast<std::size_t>(env.envs() * env.agents() * env.action_size()));
    double first = 0.0, last = 0.0;
    std::vector<int> touched(8 * 4, -100);  // decision of the last contact
    for (int k = 0; k < 300; ++k) {
      Decide(pursuit, env, env.memory.observations.data(), actions.data());
      env.VectorEnv::Step(actions.data(), env.memory.arrays());
      for (int e = 0; e < env.envs(); ++e) {
        for (int i = 0; i < env.agents(); ++i) {
          const float* row = Row(env, e, i);
          for (int f = 0; f < env.observation_size(); ++f) ASSERT_TRUE(std::isfinite(row[f]));
          // All AUVs must be under way, because fins need flow. Full rudder takes a third of the
          // slowest speed. Only contact may stop a hull.
          if (k > 20 && Norm(env.nav(e, i).v_WB_B) < 0.55) {
            EXPECT_LT(k - touched[static_cast<std::size_t>(4 * e + i)], 20) << model;
          }
          for (int j = 0; j < env.agents(); ++j) {
            const double gap = Norm(env.nav(e, i).p_WB - env.nav(e, j).p_WB);
            if (j != i && gap < 5.0) touched[static_cast<std::size_t>(4 * e + i)] = k;
          }
          const double distance = 1000.0 * std::hypot(row[kTargetOffset], row[kTargetOffset + 1]);
          (k == 0 ? first : last) += k == 0 || k >= 200 ? distance : 0.0;
        }
      }
    }
    first /= 8 * 4;
    last /= 8 * 4 * 100;
    EXPECT_GT(first, 100.0) << model;
    // AUVs cannot stop at the target, so they circle it.
    EXPECT_LT(last, first) << model;
    EXPECT_LT(last, 130.0) << model;
  }
}

TEST(SteeredEnv, AnEnvironmentIsTheSameInAnyCompanyBitForBit) {
  for (const char* model : {"vehicle.model=torpedo", "vehicle.model=kinematic"}) {
    for (const char* mode : {"mode=acoustic", "mode=truth"}) {
      const Scenario s = Torpedoes({model, mode, "time.episode_steps=15", "time.tail_steps=5"});
      VectorEnvOptions o = Few(6, 5);
      TestEnv together(s, o);
      together.Reset();
      o.envs = 1;
      o.first_env = 3;
      o.total_envs = 6;
      TestEnv alone(s, o);
      alone.Reset();
      VectorEnvOptions all = Few(6, 5);
      all.total_envs = 6;
      for (int k = 0; k < 40; ++k) {  // up to the third episode
        together.Step(ActionsOf(together, all));
        alone.Step(ActionsOf(alone, o));
        for (int i = 0; i < s.run.agents; ++i) {
          const float *a = Row(together, 3, i), *b = Row(alone, 0, i);
          for (int f = 0; f < alone.observation_size(); ++f) {
            ASSERT_EQ(a[f], b[f]) << model << mode << " step " << k << " feature " << f;
          }
        }
        ASSERT_EQ(together.memory.team_rewards[3], alone.memory.team_rewards[0]);
      }
    }
  }
}

TEST(SteeredEnv, RefusesWhatNoAutopilotCanDo) {
  EXPECT_THROW(Torpedoes({"control.interface=tau6"}), UserError);
  EXPECT_THROW(Torpedoes({"control.autopilot.period_steps=3"}), UserError);
  EXPECT_NO_THROW(Torpedoes({"control.autopilot.period_steps=20"}));
  EXPECT_THROW(VectorEnv(Torpedoes({"vehicle.torpedo.diameter_m=1.7"}), Few(1, 0)), UserError);
}

}  // namespace
}  // namespace stg::env

#include "stg_env/env/vector_env.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"

namespace stg::env {
namespace {

/// What one environment gives in each decision: observation, state, rewards and the rest.
using Story = std::vector<std::vector<float>>;

/// A random action of environment `env` in round k. It does not depend on which worker runs the
/// environment.
std::vector<float> ActionOf(const Scenario& s, int env, std::uint64_t round, int step) {
  std::vector<float> a;
  for (int i = 0; i < s.run.agents; ++i) {
    Random random(900 + static_cast<std::uint64_t>(env) + 1000 * round, Stream::kPolicy, 0,
                  static_cast<std::uint32_t>(step), static_cast<std::uint32_t>(i));
    for (int k = 0; k < s.world.control.action_size(); ++k) {
      a.push_back(static_cast<float>(random.Uniform(-1.0, 1.0)));
    }
  }
  return a;
}

/// The stories of all environments of a VectorEnv.
std::vector<Story> Together(const std::vector<Scenario>& mix, const VectorEnvOptions& o,
                            int steps) {
  VectorEnv env(mix, o);
  EnvMemory memory = env.MakeMemory();
  env.Reset(memory.arrays());
  std::vector<Story> stories(static_cast<std::size_t>(env.envs()));
  const int n = env.agents();
  for (int k = 0; k < steps; ++k) {
    std::vector<float> actions;
    for (int e = 0; e < env.envs(); ++e) {
      const auto a = ActionOf(env.scenario(e), o.first_env + e, env.round(e), env.step(e));
      actions.insert(actions.end(), a.begin(), a.end());
    }
    env.Step(actions.data(), memory.arrays());
    for (int e = 0; e < env.envs(); ++e) {
      const auto ue = static_cast<std::size_t>(e);
      std::vector<float> row;
      const auto add = [&](const std::vector<float>& all, int width) {
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(e) * width;
        row.insert(row.end(), first, first + width);
      };
      add(memory.observations, n * env.observation_size());
      add(memory.states, env.state_size());
      add(memory.rewards, n);
      row.push_back(memory.team_rewards[ue]);
      row.push_back(memory.truncated[ue]);
      if (memory.truncated[ue]) {
        add(memory.final_observations, n * env.observation_size());
        add(memory.final_states, env.state_size());
        for (const auto& item : env.metrics(e).Items()) {
          row.push_back(static_cast<float>(item.second));
        }
      }
      stories[ue].push_back(row);
    }
  }
  return stories;
}

/// The story of environment e of a run, in an object of its own.
Story Alone(const Scenario& s, VectorEnvOptions o, int e, int steps) {
  o.envs = 1;
  o.first_env = e;
  return Together({s}, o, steps).front();
}

TEST(VectorEnv, AnEnvironmentIsTheSameInAnyCompany) {
  for (const auto& [name, mode] : {std::pair{"medium", "mode=truth"},
                                   {"medium", "mode=acoustic"},
                                   {"physical", "mode=acoustic"}}) {
    Scenario a = Short(Shipped(name, "nominal", {mode, "agents=3"}), 7);
    a.run.time.decision_steps = std::min(a.run.time.decision_steps, 10);
    Scenario b = a;
    b.world.sensing.noise_std_m = 0.004;
    Scenario c = a;
    c.world.current.velocity_mps = {0.01, 0.0, 0.0};
    const std::vector<std::vector<Scenario>> mixes = {{a}, {a, b}, {a, b, c}};
    for (std::size_t m = 0; m < mixes.size(); ++m) {
      std::vector<Story> alone;
      for (const int envs : {17, 1, 3, 4, 5}) {
        for (const int first : {0, 4, 6}) {
          if (first + envs > 17) continue;
          VectorEnvOptions o;
          o.seed = 40;
          o.envs = envs;
          o.first_env = first;
          o.total_envs = 17;
          for (int e = static_cast<int>(alone.size()); e < 17; ++e) {
            alone.push_back(
                Alone(mixes[m][static_cast<std::size_t>(e / 4) % mixes[m].size()], o, e, 16));
          }
          const auto together = Together(mixes[m], o, 16);
          for (int e = 0; e < envs; ++e) {
            EXPECT_EQ(together[static_cast<std::size_t>(e)],
                      alone[static_cast<std::size_t>(first + e)])
                << name << " " << mode << ", mix of " << m + 1 << ", environment " << first + e
                << " of " << envs;
          }
        }
      }
    }
  }
}

TEST(VectorEnv, WritesWhatTheCallerWantsAndNothingElse) {
  VectorEnvOptions o;
  o.envs = 5;
  VectorEnv env(Short(Shipped("medium_release"), 3), o);
  EnvMemory memory = env.MakeMemory();
  EnvArrays wanted;
  wanted.team_rewards = memory.team_rewards.data();
  env.Reset(wanted);
  const std::vector<float> actions(static_cast<std::size_t>(5 * env.agents() * env.action_size()));
  env.Step(actions.data(), wanted);
  for (const float r : memory.team_rewards) EXPECT_NE(r, 0.0F);
  for (const float x : memory.observations) ASSERT_EQ(x, 0.0F);
}

TEST(VectorEnv, TheTeamRewardIsTheMeanOfTheAuvsRewards) {
  VectorEnvOptions o;
  o.envs = 6;
  VectorEnv env(Short(Shipped("medium"), 30), o);
  EnvMemory memory = env.MakeMemory();
  env.Reset(memory.arrays());
  std::vector<float> actions(static_cast<std::size_t>(6 * env.agents() * env.action_size()), 0.3F);
  for (int k = 0; k < 10; ++k) {
    env.Step(actions.data(), memory.arrays());
    for (int e = 0; e < 6; ++e) {
      double sum = 0.0;
      for (int i = 0; i < env.agents(); ++i) sum += memory.reward(e, i);
      EXPECT_NEAR(memory.team_rewards[static_cast<std::size_t>(e)], sum / env.agents(), 1e-6);
    }
    EXPECT_NE(memory.reward(0, 0), memory.reward(0, 1));
  }
}

TEST(VectorEnv, StaggeredFirstEpisodesEndAtTimesSpreadOverAnEpisode) {
  VectorEnvOptions o;
  o.envs = 18;
  o.stagger = true;
  VectorEnv env(Short(Shipped("medium_release"), 10), o);
  EnvMemory memory = env.MakeMemory();
  env.Reset(memory.arrays());
  const std::vector<float> actions(static_cast<std::size_t>(18 * env.agents() * env.action_size()));
  std::vector<std::vector<int>> ends(18);
  for (int k = 1; k <= 20; ++k) {
    env.Step(actions.data(), memory.arrays());
    for (std::size_t e = 0; e < 18; ++e) {
      if (memory.truncated[e]) ends[e].push_back(k);
    }
  }
  for (std::size_t e = 0; e < 18; ++e) {
    // There are five blocks, and the last one has two environments. First episodes have 2, 4, 6, 8,
    // 10 decisions. All later ones are whole.
    const int first = 2 * (static_cast<int>(e) / kMixBlock + 1);
    EXPECT_EQ(ends[e], (std::vector<int>{first, first + 10})) << e;
  }
}

/// Environment 1 is reset twice in the middle of the others' episodes. The others do not notice it.
/// The episodes of environment 1 depend on its seeds only, and not on its neighbours.
TEST(VectorEnv, AResetOfOneEnvironmentIsNoticedByNoOther) {
  for (const char* name : {"medium", "medium_release"}) {
    for (const char* mode : {"mode=truth", "mode=acoustic"}) {
      Scenario s = Short(Shipped(name, "nominal", {mode, "disturbance.force_std_n=1"}), 40);
      s.world.sensing.noise_std_m = 0.004;
      VectorEnvOptions o;
      o.seed = 70;
      TestEnv calm(s, o), mixed(s, o);
      VectorEnvOptions single;
      single.envs = 1;
      single.seed = 4321;
      TestEnv alone(s, single);
      calm.Reset();
      mixed.Reset();
      alone.Reset();
      EXPECT_EQ(alone.seed(0), 4321u);
      const int per_env = s.run.agents * s.world.control.action_size();
      for (int k = 0; k < 90; ++k) {
        if (k == 7 || k == 19) {
          mixed.ResetEnv(1, 4321);
          alone.Reset();
          EXPECT_EQ(mixed.seed(1), 4321u);
          EXPECT_EQ(mixed.step(1), 0);
          EXPECT_EQ(mixed.step(2), calm.step(2));
        }
        for (const int e : {0, 2, 3}) {
          for (int i = 0; i < s.run.agents; ++i) {
            for (int f = 0; f < s.agent.observation_size(); ++f) {
              ASSERT_EQ(Row(mixed, e, i)[f], Row(calm, e, i)[f]) << name << mode << k << " " << e;
            }
          }
        }
        const bool own = k >= 7 && mixed.seed(1) == 4321u;
        if (own) {
          for (int i = 0; i < s.run.agents; ++i) {
            for (int f = 0; f < s.agent.observation_size(); ++f) {
              ASSERT_EQ(Row(mixed, 1, i)[f], Row(alone, 0, i)[f]) << name << mode << k;
            }
          }
        }
        const std::vector<float> actions = ActionsOf(calm, o);
        const auto mine = actions.begin() + per_env;
        calm.Step(actions);
        mixed.Step(actions);
        alone.Step({mine, mine + per_env});
        if (own) {
          ASSERT_EQ(mixed.memory.team_rewards[1], alone.memory.team_rewards[0]);
          ASSERT_EQ(mixed.truncated(1), alone.truncated(0));
          if (mixed.truncated(1)) {
            EXPECT_EQ(mixed.metrics(1).Items(), alone.metrics(0).Items());
            EXPECT_EQ(mixed.metrics(1).steps, 40);
            const auto width = static_cast<std::ptrdiff_t>(mixed.state_size());
            EXPECT_TRUE(std::equal(alone.memory.final_states.begin(),
                                   alone.memory.final_states.end(),
                                   mixed.memory.final_states.begin() + width));
          }
        }
        ASSERT_EQ(mixed.memory.team_rewards[3], calm.memory.team_rewards[3]);
        ASSERT_EQ(mixed.truncated(0), calm.truncated(0));
        if (calm.truncated(0)) {
          EXPECT_EQ(mixed.metrics(0).Items(), calm.metrics(0).Items());
        }
      }
      // The next episode is the one that would have followed the broken one.
      EXPECT_EQ(mixed.round(1), 1u);
      EXPECT_EQ(mixed.seed(1), 70u + 1u + 4u);
    }
  }
}

TEST(VectorEnv, APaddedRegisterDoesNotDisturbASingleReset) {
  const Scenario s = Short(Shipped("medium"), 12);
  VectorEnvOptions o;
  o.envs = 5;
  TestEnv env(s, o), fresh(s, o);
  env.Reset();
  fresh.Reset();
  for (int k = 0; k < 30; ++k) {
    if (k == 5) env.ResetEnv(4, 9);
    const auto actions = ActionsOf(fresh, o);
    env.Step(actions);
    fresh.Step(actions);
    EXPECT_EQ(env.truncated(4), (k + 1 - 5) % 12 == 0 && k > 5) << k;
    EXPECT_EQ(env.memory.team_rewards[0], fresh.memory.team_rewards[0]);
  }
}

TEST(VectorEnv, ANonFiniteActionStopsAtTheBoundary) {
  for (const char* mode : {"mode=truth", "mode=acoustic"}) {
    TestEnv env(Short(Shipped("medium", "nominal", {mode}), 12));
    env.Reset();
    std::vector<float> actions = Idle(env);
    actions[5] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(env.Step(actions), std::invalid_argument);
    actions[5] = std::numeric_limits<float>::infinity();
    EXPECT_THROW(env.Step(actions), std::invalid_argument);
  }
}

TEST(VectorEnv, RefusesWhatCannotRunTogether) {
  const Scenario a = Shipped("medium");
  const Scenario more = Shipped("medium", "nominal", {"agents=5"});
  const Scenario forces = Shipped("medium", "nominal", {"control.interface=tau6"});
  VectorEnvOptions o;
  EXPECT_THROW(VectorEnv({a, more}, o), UserError);
  EXPECT_THROW(VectorEnv({a, forces}, o), UserError);
  EXPECT_THROW(VectorEnv(std::vector<Scenario>(), o), UserError);
  o.envs = 0;
  EXPECT_THROW(VectorEnv(a, o), UserError);
  o.envs = 5;
  o.total_envs = 4;
  EXPECT_THROW(VectorEnv(a, o), UserError);
}

}  // namespace
}  // namespace stg::env

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "env/env_fixture.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::env {
namespace {

/// All random effects at once: noise, missed detections, disturbance, moving targets.
Scenario Noisy(InformationMode mode, dynamics::ActionInterface interface) {
  Scenario s = Short(Shipped("medium"), 40);
  s.mode = mode;
  s.world.control.interface = interface;
  s.run.agents = 5;
  s.world.target.count = 2;
  s.world.target.motion = "coordinated_turn";
  s.world.sensing.noise_std_m = 0.005;
  s.world.sensing.detection_probability = 0.7;
  s.world.sensing.dropout_rate_hz = 0.2;
  s.world.disturbance.force_std_n = 1.0;
  s.world.disturbance.moment_std_nm = 0.5;
  s.world.reset.min_separation_m = 0.03;
  return s;
}

/// By reset r of a run: all observations, states and rewards of the episode after it.
using Episodes = std::map<std::uint64_t, std::vector<float>>;

Episodes Record(const Scenario& s, VectorEnvOptions o, int rounds) {
  TestEnv env(s, o);
  env.Reset();
  Episodes episodes;
  const auto n = static_cast<size_t>(env.agents() * env.observation_size());
  const auto m = static_cast<size_t>(env.state_size());
  while (env.round(0) < static_cast<std::uint64_t>(rounds)) {
    const std::uint64_t round = env.round(0);
    for (int e = 0; e < kEnvs; ++e) {
      auto& episode = episodes[static_cast<std::uint64_t>(o.first_env + e) +
                               round * static_cast<std::uint64_t>(o.total_envs)];
      const float* rows = env.memory.observation(e, 0);
      const float* state = env.memory.state(e);
      episode.insert(episode.end(), rows, rows + n);
      episode.insert(episode.end(), state, state + m);
      episode.push_back(env.step(e) > 0 ? env.memory.team_rewards[static_cast<size_t>(e)] : 0.0F);
    }
    env.Step(ActionsOf(env, o));
  }
  return episodes;
}

bool SameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(Environments, AnEpisodeIsTheSameWhicheverObjectOrRoundRunsIt) {
  for (const auto mode : {InformationMode::kTruth, InformationMode::kAcoustic}) {
    for (const auto interface :
         {dynamics::ActionInterface::kVelocity3, dynamics::ActionInterface::kTau6}) {
      const Scenario s = Noisy(mode, interface);
      VectorEnvOptions o;
      o.seed = 17;
      o.first_env = 0;
      o.total_envs = kEnvs;
      const Episodes reference = Record(s, o, 4);  // r = 0 .. 4 kEnvs - 1
      ASSERT_EQ(reference.size(), static_cast<size_t>(4 * kEnvs));
      EXPECT_FALSE(SameBits(reference.at(0), reference.at(1)));
      for (const int first : {1, 3, 6}) {
        o.first_env = first;
        o.total_envs = 3 * kEnvs;
        int compared = 0;
        for (const auto& [r, episode] : Record(s, o, 2)) {
          if (!reference.count(r)) continue;
          EXPECT_TRUE(SameBits(episode, reference.at(r))) << "reset " << r << " from " << first;
          ++compared;
        }
        EXPECT_GE(compared, kEnvs);
      }
    }
  }
}

TEST(Seeds, AnotherSeedIsAnotherEpisodeAndSeedPlusOneIsTheNextReset) {
  const Scenario s = Short(Shipped("medium_release"), 5);
  VectorEnvOptions o;
  o.seed = 100;
  const VectorEnvOptions first = o;
  o.seed = 101;
  TestEnv a(s, first), b(s, o);
  a.Reset();
  b.Reset();
  for (int e = 0; e + 1 < kEnvs; ++e) {
    EXPECT_EQ(std::memcmp(Row(a, e + 1, 0), Row(b, e, 0), sizeof(float) * 74), 0);
    EXPECT_NE(std::memcmp(Row(a, e, 0), Row(b, e, 0), sizeof(float) * 74), 0);
  }
}

TEST(Truncation, FinalObservationsAreThoseOfALongerEpisode) {
  for (const auto mode : {InformationMode::kTruth, InformationMode::kAcoustic}) {
    const Scenario s = Noisy(mode, dynamics::ActionInterface::kVelocity3);
    const VectorEnvOptions o;
    TestEnv brief(Short(s, 12), o), longer(Short(s, 30), o), fresh(Short(s, 12), o);
    brief.Reset();
    longer.Reset();
    for (int k = 0; k < 12; ++k) {
      EXPECT_FALSE(brief.truncated());
      const auto actions = ActionsOf(brief, o);
      brief.Step(actions);
      longer.Step(actions);
      EXPECT_EQ(brief.memory.team_rewards, longer.memory.team_rewards);
    }
    EXPECT_TRUE(brief.truncated());
    EXPECT_FALSE(longer.truncated());
    const auto expected = longer.memory.observations, state = longer.memory.states;
    EXPECT_TRUE(SameBits(brief.memory.final_observations, expected));
    EXPECT_TRUE(SameBits(brief.memory.final_states, state));
    // The arrays now belong to the next episode.
    EXPECT_EQ(brief.step(0), 0);
    EXPECT_EQ(brief.round(0), 1u);
    fresh.RestartAt(1);
    EXPECT_TRUE(SameBits(brief.memory.observations, fresh.memory.observations));
    EXPECT_TRUE(SameBits(brief.memory.states, fresh.memory.states));
    EXPECT_FALSE(SameBits(brief.memory.observations, expected));
    brief.Step(ActionsOf(brief, o));
    EXPECT_FALSE(brief.truncated());
  }
}

TEST(Restart, AtARoundEqualsHavingRunUpToIt) {
  for (const auto mode : {InformationMode::kTruth, InformationMode::kAcoustic}) {
    const Scenario s = Short(Noisy(mode, dynamics::ActionInterface::kVelocity3), 9);
    VectorEnvOptions o;
    o.first_env = 4;
    o.total_envs = 12;
    TestEnv run(s, o), resumed(s, o);
    run.Reset();
    while (run.round(0) < 3) run.Step(ActionsOf(run, o));
    resumed.RestartAt(3);
    for (int k = 0; k < 9; ++k) {
      EXPECT_TRUE(SameBits(run.memory.observations, resumed.memory.observations)) << k;
      EXPECT_TRUE(SameBits(run.memory.states, resumed.memory.states)) << k;
      run.Step(ActionsOf(run, o));
      resumed.Step(ActionsOf(resumed, o));
      EXPECT_EQ(run.memory.team_rewards, resumed.memory.team_rewards);
    }
    for (int e = 0; e < kEnvs; ++e) {
      EXPECT_EQ(run.metrics(e).Items(), resumed.metrics(e).Items());
    }
  }
}

TEST(Restart, AShortFirstEpisodeIsFollowedByFullOnes) {
  VectorEnvOptions o;
  o.stagger = true;
  // This is the first of two blocks, so its first episode has half of 7 decisions.
  o.total_envs = 8;
  TestEnv env(Short(Shipped("medium_release"), 7), o);
  env.Reset();
  std::vector<int> lengths;
  for (int k = 1, start = 0; k <= 17; ++k) {
    env.Step(ActionsOf(env, o));
    if (env.truncated()) {
      lengths.push_back(k - start);
      start = k;
      EXPECT_EQ(env.metrics(0).steps, lengths.back());
    }
  }
  EXPECT_EQ(lengths, (std::vector<int>{3, 7, 7}));
}

TEST(Curriculum, TheStageFollowsTheNumberOfResetsOfAllCopies) {
  Scenario s = Short(Shipped("medium_release"), 2);
  s.world.reset.stages[0].auv_distance_m = {0.10, 0.15};
  s.world.reset.stages[1].auv_distance_m = {0.25, 0.30};
  s.world.reset.stages[2].auv_distance_m = {0.50, 0.55};
  s.world.reset.min_separation_m = 0.03;
  s.world.reset.curriculum = true;
  s.world.reset.curriculum_easy_resets = 7;
  s.world.reset.curriculum_medium_resets = 18;
  for (const bool curriculum : {true, false}) {
    VectorEnvOptions o;
    o.curriculum = curriculum;
    o.first_env = 2;
    o.total_envs = 8;
    TestEnv env(s, o);
    for (std::uint64_t round = 0; round < 4; ++round) {
      env.RestartAt(round);
      for (int e = 0; e < kEnvs; ++e) {
        const int r = 2 + e + 8 * static_cast<int>(round);
        const size_t stage = !curriculum ? 1 : r < 7 ? 0 : r < 18 ? 1 : 2;
        for (int i = 0; i < 4; ++i) {
          const double d = env.tracking(e, i).distance;
          EXPECT_GE(d, s.world.reset.stages[stage].auv_distance_m.lo - 1e-9) << r;
          EXPECT_LE(d, s.world.reset.stages[stage].auv_distance_m.hi + 1e-9) << r;
        }
      }
    }
  }
}

TEST(Rewards, TheTeamRewardIsTheMeanOverAuvsAndTheReturnTheirSum) {
  for (const char* name : {"medium", "medium_release"}) {
    VectorEnvOptions o;
    TestEnv env(Short(Shipped(name), 20), o);
    env.Reset();
    std::vector<double> sum(kEnvs, 0.0);
    do {
      env.Step(ActionsOf(env, o));
      for (int e = 0; e < kEnvs; ++e) {
        double total = 0.0;
        for (int i = 0; i < 4; ++i) total += env.terms(e, i).total;
        EXPECT_NEAR(env.memory.team_rewards[static_cast<size_t>(e)], total / 4.0, 1e-6);
        sum[static_cast<size_t>(e)] += total;
      }
    } while (!env.truncated());
    for (int e = 0; e < kEnvs; ++e) {
      EXPECT_NEAR(env.metrics(e).episode_return, sum[static_cast<size_t>(e)], 1e-9);
    }
  }
}

TEST(Decision, OfSeveralPhysicsStepsHoldsItsActionForAllOfThem) {
  // tau6 has no filter, so one decision of five steps equals five decisions of one step.
  Scenario one = Short(Shipped("medium_release"), 50);
  one.world.control.interface = dynamics::ActionInterface::kTau6;
  Scenario five = one;
  five.run.time.decision_steps = 5;
  const VectorEnvOptions o;
  TestEnv a(one, o), b(five, o);
  a.Reset();
  b.Reset();
  for (int k = 0; k < 4; ++k) {
    const auto actions = ActionsOf(b, o);
    for (int j = 0; j < 5; ++j) a.Step(actions);
    b.Step(actions);
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(a.vehicle(0, i).p_WB.x, b.vehicle(0, i).p_WB.x);
    }
  }
  EXPECT_DOUBLE_EQ(Seconds(b.time(0)), 2.0);
}

/// The swarm and the target are at rest, so every metric has a closed form.
TEST(Metrics, OfASwarmAtRestAreItsGeometry) {
  Scenario s = Short(Shipped("medium_release", "nominal", {"agents=3", "contact.stiffness=0"}), 10);
  s.run.time.tail_steps = 4;
  TestEnv env(s, VectorEnvOptions{});
  // The first AUV is in the band at 0.014 m. The second one touches it at 0.018 m. The third one
  // has lost the target at 0.7 m.
  env.Place({{0.014, 0.0, 0.0}, {0.032, 0.0, 0.0}, {0.7, 0.0, 0.0}}, {{0.0, 0.0, 0.0}},
            {{0.0, 0.0, 0.0}});
  double total = 0.0;
  for (int k = 0; k < 10; ++k) {
    env.Step(Idle(env));
    if (k == 8) {
      for (int i = 0; i < 3; ++i) total += 10.0 * env.terms(0, i).total;
    }
  }
  ASSERT_TRUE(env.truncated());
  const task::EpisodeMetrics& m = env.metrics(kEnvs - 1);
  EXPECT_EQ(m.steps, 10);
  EXPECT_NEAR(m.tail_distance, (0.014 + 0.032 + 0.7) / 3.0, 1e-12);
  EXPECT_NEAR(m.tracking_error, (0.001 + 0.017 + 0.685) / 3.0, 1e-12);
  EXPECT_NEAR(m.mean_error, m.tracking_error, 1e-12);
  EXPECT_NEAR(m.lost_rate, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(m.whole_lost_rate, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(m.band_rate, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(m.colliding_pairs, 1.0, 1e-12);
  EXPECT_NEAR(m.tail_colliding_pairs, 1.0, 1e-12);
  EXPECT_NEAR(m.min_separation, 0.018, 1e-12);
  // One AUV is in the band after the first decision, two AUVs never: 0.1 s, 1 s, 1 s.
  EXPECT_NEAR(m.time_to_band, 2.1 / 3.0, 1e-12);
  EXPECT_EQ(m.action_norm, 0.0);
  EXPECT_EQ(m.saturation_rate, 0.0);
  EXPECT_EQ(m.control_cost, 0.0);
  EXPECT_NEAR(m.episode_return, total, 1e-9);
}

TEST(Metrics, TheTailIsTheLastStepsOnly) {
  Scenario s = Short(Shipped("medium_release", "nominal", {"agents=1"}), 20);
  s.run.time.tail_steps = 5;
  TestEnv env(s, VectorEnvOptions{});
  const double speed = 0.01;
  env.Place({{0.1, 0.0, 0.0}}, {{0.0, 0.0, 0.0}}, {{-speed, 0.0, 0.0}});
  for (int k = 0; k < 20; ++k) env.Step(Idle(env));
  // The target leaves at 1 mm a step. The tail is steps 16 to 20, with mean 18.
  EXPECT_NEAR(env.metrics(0).tail_distance, 0.1 + 18.0 * 0.001, 1e-9);
  EXPECT_NEAR(env.metrics(0).mean_error, 0.085 + 10.5 * 0.001, 1e-9);
}

TEST(Metrics, SaturationCountsExecutedComponentsAndTheNormIsOfTau) {
  Scenario s = Short(Shipped("medium_release", "nominal", {"agents=1"}), 4);
  s.world.control.interface = dynamics::ActionInterface::kTau6;
  TestEnv env(s, VectorEnvOptions{});
  env.Place({{0.0, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
  std::vector<float> actions;
  for (int e = 0; e < kEnvs; ++e) {
    for (const float a : {0.96F, -1.0F, 0.5F, 0.0F, 0.0F, 0.94F}) actions.push_back(a);
  }
  for (int k = 0; k < 4; ++k) env.Step(actions);
  EXPECT_NEAR(env.metrics(0).saturation_rate, 2.0 / 6.0, 1e-12);
  const double norm = std::sqrt(0.96 * 0.96 + 1.0 + 0.25 + 0.94 * 0.94);
  EXPECT_NEAR(env.metrics(0).action_norm, norm, 1e-6);
  // The action is constant after the first step. The level counts 0.6 of the mean square in each
  // step, the change 0.4 of it once.
  EXPECT_NEAR(env.metrics(0).control_cost, norm * norm / 6.0 * (0.6 + 0.4 / 4.0), 1e-6);
}

TEST(Metrics, SummaryIsMeanAndSampleStandardDeviation) {
  std::vector<task::EpisodeMetrics> episodes(3);
  episodes[0].episode_return = 1.0;
  episodes[1].episode_return = 2.0;
  episodes[2].episode_return = 6.0;
  const task::MetricSummary s = task::Summarise(episodes);
  ASSERT_EQ(s.names[0], "return");
  EXPECT_DOUBLE_EQ(s.mean[0], 3.0);
  EXPECT_DOUBLE_EQ(s.std[0], std::sqrt((4.0 + 1.0 + 9.0) / 2.0));
  EXPECT_EQ(task::Summarise({episodes[0]}).std[0], 0.0);
}

}  // namespace
}  // namespace stg::env

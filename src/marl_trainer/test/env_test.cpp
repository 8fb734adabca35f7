#include "marl_trainer/env/env.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "env_fixture.hpp"

namespace stg::env {
namespace {

/// Everything random at once: noise, missed detections, disturbance, moving targets.
Scenario Noisy(InformationMode mode, dynamics::ActionInterface interface) {
  Scenario s = Short(Shipped("medium"), 40);
  s.mode = mode;
  s.control.interface = interface;
  s.agents = 5;
  s.target.count = 2;
  s.target.motion = "coordinated_turn";
  s.sensing.noise_std_m = 0.005;
  s.sensing.detection_probability = 0.7;
  s.sensing.dropout_rate_hz = 0.2;
  s.disturbance.force_std_n = 1.0;
  s.disturbance.moment_std_nm = 0.5;
  s.reset.min_separation_m = 0.03;
  return s;
}

/// What reset r of a run gives: all observations, states and rewards of its episode.
using Episodes = std::map<std::uint64_t, std::vector<float>>;

Episodes Record(const Scenario& s, EnvOptions o, int rounds) {
  EnvGroup env(s, o);
  env.Reset();
  Episodes episodes;
  const auto n = static_cast<size_t>(env.agents() * env.observation_size());
  const auto m = static_cast<size_t>(env.state_size());
  while (env.round() < static_cast<std::uint64_t>(rounds)) {
    const std::uint64_t round = env.round();
    for (int lane = 0; lane < kLanes; ++lane) {
      auto& e = episodes[static_cast<std::uint64_t>(o.first_env + lane) +
                         round * static_cast<std::uint64_t>(o.total_envs)];
      const float* rows = env.observations() + static_cast<size_t>(lane) * n;
      const float* state = env.states() + static_cast<size_t>(lane) * m;
      e.insert(e.end(), rows, rows + n);
      e.insert(e.end(), state, state + m);
      e.push_back(env.step() > 0 ? env.rewards()[lane] : 0.0F);
    }
    env.Step(ActionsOf(env, o).data());
  }
  return episodes;
}

bool SameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(Lanes, AnEpisodeIsTheSameWhicheverLaneGroupOrRoundRunsIt) {
  for (const auto mode : {InformationMode::kTruth, InformationMode::kAcoustic}) {
    for (const auto interface :
         {dynamics::ActionInterface::kVelocity3, dynamics::ActionInterface::kTau6}) {
      const Scenario s = Noisy(mode, interface);
      EnvOptions o;
      o.seed = 17;
      o.first_env = 0;
      o.total_envs = kLanes;
      const Episodes reference = Record(s, o, 4);  // r = 0 .. 4 kLanes - 1
      ASSERT_EQ(reference.size(), static_cast<size_t>(4 * kLanes));
      EXPECT_FALSE(SameBits(reference.at(0), reference.at(1)));
      for (const int first : {1, 3, 6}) {
        o.first_env = first;
        o.total_envs = 3 * kLanes;
        int compared = 0;
        for (const auto& [r, episode] : Record(s, o, 2)) {
          if (!reference.count(r)) continue;
          EXPECT_TRUE(SameBits(episode, reference.at(r))) << "reset " << r << " from " << first;
          ++compared;
        }
        EXPECT_GE(compared, kLanes);
      }
    }
  }
}

TEST(Lanes, APairInContactDoesNotMoveTheFarPairOfAnotherLane) {
  dynamics::World alone(Shipped("medium", "nominal", {"agents=2"}));
  dynamics::World mixed(Shipped("medium", "nominal", {"agents=2"}));
  for (int lane = 0; lane < kLanes; ++lane) {
    const double gap = lane == 1 ? 0.02 : 0.07;
    alone.Place(lane, {{0.0, 0.0, 0.0}, {0.07, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{}});
    mixed.Place(lane, {{0.0, 0.0, 0.0}, {gap, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{}});
  }
  const std::vector<dynamics::Wrench<Pack>> nothing(2);
  for (int k = 0; k < 10; ++k) {
    alone.Step(nothing);
    mixed.Step(nothing);
  }
  EXPECT_EQ(Lane(mixed.vehicle(0).v_WB.x, 0), Lane(alone.vehicle(0).v_WB.x, 0));
  EXPECT_LT(Lane(mixed.vehicle(0).v_WB.x, 1), -1e-4);
}

TEST(Seeds, AnotherSeedIsAnotherEpisodeAndSeedPlusOneIsTheNextReset) {
  const Scenario s = Short(Shipped("medium_release"), 5);
  EnvOptions o;
  o.seed = 100;
  const EnvOptions first = o;
  o.seed = 101;
  EnvGroup a(s, first), b(s, o);
  a.Reset();
  b.Reset();
  for (int lane = 0; lane + 1 < kLanes; ++lane) {
    EXPECT_EQ(std::memcmp(Row(a, lane + 1, 0), Row(b, lane, 0), sizeof(float) * 74), 0);
    EXPECT_NE(std::memcmp(Row(a, lane, 0), Row(b, lane, 0), sizeof(float) * 74), 0);
  }
}

TEST(Truncation, FinalObservationsAreThoseOfALongerEpisode) {
  for (const auto mode : {InformationMode::kTruth, InformationMode::kAcoustic}) {
    const Scenario s = Noisy(mode, dynamics::ActionInterface::kVelocity3);
    const EnvOptions o;
    EnvGroup brief(Short(s, 12), o), longer(Short(s, 30), o), fresh(Short(s, 12), o);
    brief.Reset();
    longer.Reset();
    for (int k = 0; k < 12; ++k) {
      EXPECT_FALSE(brief.truncated());
      const auto actions = ActionsOf(brief, o);
      brief.Step(actions.data());
      longer.Step(actions.data());
      EXPECT_EQ(std::memcmp(brief.rewards(), longer.rewards(), sizeof(float) * kLanes), 0);
    }
    EXPECT_TRUE(brief.truncated());
    EXPECT_FALSE(longer.truncated());
    const auto expected = Observations(longer), state = States(longer);
    EXPECT_EQ(
        std::memcmp(brief.final_observations(), expected.data(), expected.size() * sizeof(float)),
        0);
    EXPECT_EQ(std::memcmp(brief.final_states(), state.data(), state.size() * sizeof(float)), 0);
    // What comes next belongs to the next episode.
    EXPECT_EQ(brief.step(), 0);
    EXPECT_EQ(brief.round(), 1u);
    fresh.RestartAt(1, 0);
    EXPECT_TRUE(SameBits(Observations(brief), Observations(fresh)));
    EXPECT_TRUE(SameBits(States(brief), States(fresh)));
    EXPECT_FALSE(SameBits(Observations(brief), expected));
    brief.Step(ActionsOf(brief, o).data());
    EXPECT_FALSE(brief.truncated());
  }
}

TEST(Restart, AtARoundEqualsHavingRunUpToIt) {
  for (const auto mode : {InformationMode::kTruth, InformationMode::kAcoustic}) {
    const Scenario s = Short(Noisy(mode, dynamics::ActionInterface::kVelocity3), 9);
    EnvOptions o;
    o.first_env = 4;
    o.total_envs = 12;
    EnvGroup run(s, o), resumed(s, o);
    run.Reset();
    while (run.round() < 3) run.Step(ActionsOf(run, o).data());
    resumed.RestartAt(3, 0);
    for (int k = 0; k < 9; ++k) {
      EXPECT_TRUE(SameBits(Observations(run), Observations(resumed))) << k;
      EXPECT_TRUE(SameBits(States(run), States(resumed))) << k;
      run.Step(ActionsOf(run, o).data());
      resumed.Step(ActionsOf(resumed, o).data());
      EXPECT_EQ(std::memcmp(run.rewards(), resumed.rewards(), sizeof(float) * kLanes), 0);
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_EQ(run.metrics(lane).Items(), resumed.metrics(lane).Items());
    }
  }
}

TEST(Restart, AShortFirstEpisodeIsFollowedByFullOnes) {
  EnvOptions o;
  o.first_episode_steps = 3;
  EnvGroup env(Short(Shipped("medium_release"), 7), o);
  env.Reset();
  std::vector<int> lengths;
  for (int k = 1, start = 0; k <= 17; ++k) {
    env.Step(ActionsOf(env, o).data());
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
  s.reset.stages[0].auv_distance_m = {0.10, 0.15};
  s.reset.stages[1].auv_distance_m = {0.25, 0.30};
  s.reset.stages[2].auv_distance_m = {0.50, 0.55};
  s.reset.min_separation_m = 0.03;
  s.reset.curriculum_easy_resets = 7;
  s.reset.curriculum_medium_resets = 18;
  for (const bool curriculum : {true, false}) {
    EnvOptions o;
    o.curriculum = curriculum;
    o.first_env = 2;
    o.total_envs = 8;
    EnvGroup env(s, o);
    for (std::uint64_t round = 0; round < 4; ++round) {
      env.RestartAt(round, 0);
      for (int lane = 0; lane < kLanes; ++lane) {
        const int r = 2 + lane + 8 * static_cast<int>(round);
        const size_t stage = !curriculum ? 1 : r < 7 ? 0 : r < 18 ? 1 : 2;
        for (int i = 0; i < 4; ++i) {
          const double d = Lane(env.truth(i).distance, lane);
          EXPECT_GE(d, s.reset.stages[stage].auv_distance_m.lo - 1e-9) << r;
          EXPECT_LE(d, s.reset.stages[stage].auv_distance_m.hi + 1e-9) << r;
        }
      }
    }
  }
}

TEST(Rewards, TheTeamRewardIsTheMeanOverAuvsAndTheReturnTheirSum) {
  for (const char* name : {"medium", "medium_release"}) {
    EnvOptions o;
    EnvGroup env(Short(Shipped(name), 20), o);
    env.Reset();
    std::vector<double> sum(kLanes, 0.0);
    do {
      env.Step(ActionsOf(env, o).data());
      for (int lane = 0; lane < kLanes; ++lane) {
        double total = 0.0;
        for (int i = 0; i < 4; ++i) total += Lane(env.terms(i).total, lane);
        EXPECT_NEAR(env.rewards()[lane], total / 4.0, 1e-6);
        sum[static_cast<size_t>(lane)] += total;
      }
    } while (!env.truncated());
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_NEAR(env.metrics(lane).episode_return, sum[static_cast<size_t>(lane)], 1e-9);
    }
  }
}

TEST(Decision, OfSeveralPhysicsStepsHoldsItsActionForAllOfThem) {
  // tau6 has no filter: one decision of five steps is five decisions of one step.
  Scenario one = Short(Shipped("medium_release"), 50);
  one.control.interface = dynamics::ActionInterface::kTau6;
  Scenario five = one;
  five.time.decision_steps = 5;
  const EnvOptions o;
  EnvGroup a(one, o), b(five, o);
  a.Reset();
  b.Reset();
  for (int k = 0; k < 4; ++k) {
    const auto actions = ActionsOf(b, o);
    for (int j = 0; j < 5; ++j) a.Step(actions.data());
    b.Step(actions.data());
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(Lane(a.world().vehicle(i).p_WB.x, 0), Lane(b.world().vehicle(i).p_WB.x, 0));
    }
  }
  EXPECT_DOUBLE_EQ(Seconds(b.world().time(0)), 2.0);
}

/// At rest around a target at rest: every metric has a closed form.
TEST(Metrics, OfASwarmAtRestAreItsGeometry) {
  Scenario s = Short(Shipped("medium_release", "nominal", {"agents=3", "contact.stiffness=0"}), 10);
  s.time.tail_steps = 4;
  EnvGroup env(s, EnvOptions{});
  // In the band at 0.014 m, in contact with it at 0.018 m, and lost at 0.7 m.
  env.Place({{0.014, 0.0, 0.0}, {0.032, 0.0, 0.0}, {0.7, 0.0, 0.0}}, {{0.0, 0.0, 0.0}},
            {{0.0, 0.0, 0.0}});
  double total = 0.0;
  for (int k = 0; k < 10; ++k) {
    env.Step(Idle(env).data());
    if (k == 8) {
      for (int i = 0; i < 3; ++i) total += 10.0 * Lane(env.terms(i).total, 0);
    }
  }
  ASSERT_TRUE(env.truncated());
  const task::EpisodeMetrics& m = env.metrics(kLanes - 1);
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
  // One AUV is in the band after the first decision, two never: 0.1 s, 1 s, 1 s.
  EXPECT_NEAR(m.time_to_band, 2.1 / 3.0, 1e-12);
  EXPECT_EQ(m.action_norm, 0.0);
  EXPECT_EQ(m.saturation_rate, 0.0);
  EXPECT_EQ(m.control_cost, 0.0);
  EXPECT_NEAR(m.episode_return, total, 1e-9);
}

TEST(Metrics, TheTailIsTheLastStepsOnly) {
  Scenario s = Short(Shipped("medium_release", "nominal", {"agents=1"}), 20);
  s.time.tail_steps = 5;
  EnvGroup env(s, EnvOptions{});
  const double speed = 0.01;
  env.Place({{0.1, 0.0, 0.0}}, {{0.0, 0.0, 0.0}}, {{-speed, 0.0, 0.0}});
  for (int k = 0; k < 20; ++k) env.Step(Idle(env).data());
  // The target leaves at 1 mm a step; the tail is steps 16 to 20, mean 18.
  EXPECT_NEAR(env.metrics(0).tail_distance, 0.1 + 18.0 * 0.001, 1e-9);
  EXPECT_NEAR(env.metrics(0).mean_error, 0.085 + 10.5 * 0.001, 1e-9);
}

TEST(Metrics, SaturationCountsExecutedComponentsAndTheNormIsOfTau) {
  Scenario s = Short(Shipped("medium_release", "nominal", {"agents=1"}), 4);
  s.control.interface = dynamics::ActionInterface::kTau6;
  EnvGroup env(s, EnvOptions{});
  env.Place({{0.0, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
  std::vector<float> actions;
  for (int lane = 0; lane < kLanes; ++lane) {
    for (const float a : {0.96F, -1.0F, 0.5F, 0.0F, 0.0F, 0.94F}) actions.push_back(a);
  }
  for (int k = 0; k < 4; ++k) env.Step(actions.data());
  EXPECT_NEAR(env.metrics(0).saturation_rate, 2.0 / 6.0, 1e-12);
  const double norm = std::sqrt(0.96 * 0.96 + 1.0 + 0.25 + 0.94 * 0.94);
  EXPECT_NEAR(env.metrics(0).action_norm, norm, 1e-6);
  // Constant after the first step: level 0.6 and, once, change 0.4 of the mean square.
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

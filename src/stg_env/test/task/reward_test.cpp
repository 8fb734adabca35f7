#include "stg_env/task/reward.hpp"

#include <gtest/gtest.h>

#include "env/env_fixture.hpp"

namespace stg::task {
namespace {

Scenario With(RewardKind kind) {
  Scenario s;
  s.reward.kind = kind;
  return s;
}

constexpr double kRest[6] = {};

RewardInput<double> Input(double previous, double distance, double closing, double confidence,
                          bool lost = false) {
  RewardInput<double> in;
  in.previous_distance = previous;
  in.distance = distance;
  in.closing = closing;
  in.confidence = confidence;
  in.lost = lost ? 1.0 : 0.0;
  in.tau = in.previous_tau = in.action = in.previous_action = kRest;
  return in;
}

// Every expected number below is computed by hand from Eqs. 28-36, with the band [0.010, 0.015] m,
// e_max 0.8 m, progress scale 0.04 m, closing scale 0.08 m/s.

TEST(Reward, ApproachingOutsideTheBandMatchesTheEquationsByHand) {
  // P = C = 0.5, U = 0, b = 0.185, B = 0.76875, R = 0.25.
  RewardInput<double> in = Input(0.22, 0.20, 0.04, 0.5);
  const double effort[6] = {0.6}, before[6] = {0.0, 0.6};
  in.tau = in.action = effort;
  in.previous_tau = in.previous_action = before;
  const RewardTerms<double> paper = Reward(With(RewardKind::kPaper).judge(), in, 0.9, 0.6);
  EXPECT_NEAR(paper.track, 0.5440625, 1e-12);
  EXPECT_NEAR(paper.observation, 0.5, 1e-12);
  EXPECT_NEAR(paper.coordination, 0.9, 1e-12);
  EXPECT_NEAR(paper.communication, 0.6, 1e-12);
  EXPECT_NEAR(paper.semantic, 0.5, 1e-12);
  EXPECT_NEAR(paper.cost, 0.6 * 0.36 + 0.4 * 0.72, 1e-12);
  EXPECT_NEAR(paper.total, 0.500405, 1e-12);

  const RewardTerms<double> release = Reward(With(RewardKind::kRelease).judge(), in, 0.9, 0.6);
  EXPECT_NEAR(release.track, 0.5440625, 1e-12);
  EXPECT_NEAR(release.semantic, 0.5, 1e-12);
  EXPECT_NEAR(release.cost, 0.084, 1e-12);
  EXPECT_NEAR(release.total, 0.534005, 1e-12);

  Scenario s = With(RewardKind::kReleaseRaw);
  s.reward.weights = {0.55, 0.20, 0.10, 0.05, 0.0, 0.08, 0.0};
  const RewardTerms<double> raw = Reward(s.judge(), in, 0.9, 0.6);
  EXPECT_NEAR(raw.track, 0.6209375, 1e-12);  // e = 0.185
  EXPECT_NEAR(raw.cost, 0.081, 1e-12);
  EXPECT_NEAR(raw.total, 0.555035625, 1e-12);
}

TEST(Reward, StablePhaseIsWhereThePaperAndTheReleaseDiffer) {
  // Above the band, but near it: P = 0, C = -0.5, b = 0.035, B = 0.95625.
  const RewardInput<double> in = Input(0.05, 0.05, -0.04, 0.8);
  const RewardTerms<double> paper = Reward(With(RewardKind::kPaper).judge(), in, 0.0, 0.0);
  EXPECT_NEAR(paper.track, 0.2596875, 1e-12);
  EXPECT_NEAR(paper.semantic, 0.89, 1e-12);
  EXPECT_NEAR(Reward(With(RewardKind::kRelease).judge(), in, 0.0, 0.0).semantic, -0.175, 1e-12);
}

TEST(Reward, LostEarnsProgressOnly) {
  // P = -0.5, B = 0, R = P.
  const RewardInput<double> in = Input(0.88, 0.90, 0.0, 0.0, true);
  for (const RewardKind kind : {RewardKind::kPaper, RewardKind::kRelease}) {
    const RewardTerms<double> r = Reward(With(kind).judge(), in, 0.0, 0.0);
    EXPECT_NEAR(r.track, -0.25, 1e-12);
    EXPECT_NEAR(r.observation, -1.0, 1e-12);
    EXPECT_NEAR(r.semantic, -0.5, 1e-12);
    EXPECT_NEAR(r.total, 0.72 * -0.25 - 0.16 + 0.09 * -0.5, 1e-12);
  }
}

TEST(Reward, TooCloseIsPenalised) {
  // U = 0.5, b = 0.005, B = 0.99375.
  const RewardInput<double> in = Input(0.005, 0.005, 0.0, 0.9);
  const RewardTerms<double> paper = Reward(With(RewardKind::kPaper).judge(), in, 0.0, 0.0);
  EXPECT_NEAR(paper.track, 0.2478125, 1e-12);
  EXPECT_NEAR(paper.semantic, 0.55 * 0.9 + 0.45 * 0.5, 1e-12);
  EXPECT_NEAR(Reward(With(RewardKind::kRelease).judge(), in, 0.0, 0.0).semantic, -0.125, 1e-12);
}

TEST(Reward, InsideTheBandProgressEarnsNoReacquisition) {
  // P = 0.5, C = 0, B = 1, R = 0.
  const RewardInput<double> in = Input(0.0325, 0.0125, 0.0, 0.9);
  for (const RewardKind kind : {RewardKind::kPaper, RewardKind::kRelease}) {
    const RewardTerms<double> r = Reward(With(kind).judge(), in, 0.0, 0.0);
    EXPECT_NEAR(r.track, 0.5, 1e-12);
    EXPECT_NEAR(r.semantic, 0.55 * 0.9 + 0.45, 1e-12);
  }
}

TEST(Reward, EveryTermAndTheTotalStayWithinTheirLimits) {
  Scenario s = With(RewardKind::kPaper);
  RewardInput<double> in = Input(10.0, 0.012, 10.0, 1.0);
  const double all[6] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  in.action = all;
  s.reward.w_band = 5.0;
  RewardTerms<double> r = Reward(s.judge(), in, 1.0, 1.0);
  EXPECT_EQ(r.track, 1.0);
  EXPECT_EQ(r.cost, 1.0);
  s.reward.weights.tracking = 10.0;
  EXPECT_EQ(Reward(s.judge(), in, 1.0, 1.0).total, 2.0);
  in = Input(0.0, 10.0, -10.0, 0.0, true);
  s.reward.w_progress = 5.0;
  r = Reward(s.judge(), in, 0.0, 0.0);
  EXPECT_EQ(r.track, -1.0);
  EXPECT_EQ(r.total, -2.0);
  // Progress and closing are limited to one unit of their scales.
  const agent::ObservationConfig o;
  EXPECT_EQ(agent::Progress(o, 1.0, 0.0), 1.0);
  EXPECT_EQ(agent::Progress(o, 0.0, 1.0), -1.0);
  EXPECT_EQ(agent::Closing(o, 1.0), 1.0);
}

TEST(Reward, EachWeightScalesItsTermAlone) {
  RewardInput<double> in = Input(0.22, 0.20, 0.04, 0.5);
  const double half[6] = {0.5};
  in.action = half;
  in.crowding = 0.3;
  Scenario s = With(RewardKind::kPaper);
  const RewardTerms<double> r = Reward(s.judge(), in, 0.9, 0.6);
  const auto only = [&](double RewardWeights::*weight) {
    s.reward.weights = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    s.reward.weights.*weight = 0.5;
    return Reward(s.judge(), in, 0.9, 0.6).total;
  };
  EXPECT_NEAR(only(&RewardWeights::tracking), 0.5 * r.track, 1e-15);
  EXPECT_NEAR(only(&RewardWeights::observation), 0.5 * r.observation, 1e-15);
  EXPECT_NEAR(only(&RewardWeights::coordination), 0.5 * r.coordination, 1e-15);
  EXPECT_NEAR(only(&RewardWeights::communication), 0.5 * r.communication, 1e-15);
  EXPECT_NEAR(only(&RewardWeights::semantic), 0.5 * r.semantic, 1e-15);
  EXPECT_NEAR(only(&RewardWeights::control_cost), -0.5 * r.cost, 1e-15);
  EXPECT_NEAR(only(&RewardWeights::separation), -0.5 * 0.3, 1e-15);
}

TEST(Reward, BandDeviationIsTheDistanceToTheBand) {
  const RewardConfig c;
  EXPECT_NEAR(BandDeviation(c, 0.007), 0.003, 1e-15);
  EXPECT_EQ(BandDeviation(c, 0.010), 0.0);
  EXPECT_EQ(BandDeviation(c, 0.0125), 0.0);
  EXPECT_EQ(BandDeviation(c, 0.015), 0.0);
  EXPECT_NEAR(BandDeviation(c, 0.115), 0.1, 1e-15);
}

TEST(Reward, PacksAndScalarsGiveTheSameBits) {
  Random random(5, Stream::kPolicy, 0, 0, 0);
  for (const RewardKind kind :
       {RewardKind::kPaper, RewardKind::kRelease, RewardKind::kReleaseRaw}) {
    const Scenario s = With(kind);
    for (int trial = 0; trial < 200; ++trial) {
      const double d = random.Uniform(0.0, trial % 2 == 0 ? 0.02 : 0.9);
      RewardInput<double> a = Input(d + random.Uniform(-0.05, 0.05), d, random.Uniform(-0.1, 0.1),
                                    random.Uniform(), d > 0.65);
      RewardInput<Pack> b;
      double tau[6], action[6];
      Pack taus[6], actions[6];
      const Pack rest[6] = {};
      for (int k = 0; k < 6; ++k) {
        taus[k] = Pack(tau[k] = random.Uniform(-1.0, 1.0));
        actions[k] = Pack(action[k] = random.Uniform(-1.0, 1.0));
      }
      a.tau = tau;
      a.action = action;
      b.tau = taus;
      b.action = actions;
      b.previous_tau = b.previous_action = rest;
      b.distance = Pack(a.distance);
      b.previous_distance = Pack(a.previous_distance);
      b.closing = Pack(a.closing);
      b.confidence = Pack(a.confidence);
      b.lost = Pack(a.lost);
      const double expected = Reward(s.judge(), a, 0.4, 0.3).total;
      EXPECT_EQ(Lane(Reward(s.judge(), b, Pack(0.4), Pack(0.3)).total, kLanes - 1), expected);
    }
  }
}

/// Four AUVs on a line at 0, 0.09, 0.27 and 0.87 m, at rest, far from the target.
env::TestEnv Line(const Scenario& s) {
  env::TestEnv env(s, env::VectorEnvOptions{});
  env.Place({{0.0, 0.0, 0.0}, {0.09, 0.0, 0.0}, {0.27, 0.0, 0.0}, {0.87, 0.0, 0.0}},
            {{0.0, 0.5, 0.0}}, {{0.0, 0.0, 0.0}});
  env.Step(Idle(env));
  return env;
}

TEST(SwarmReward, CommunicationIsTheMeanOverExistingLinksOnly) {
  const env::TestEnv env = Line(env::Shipped("medium", "nominal", {"mode=truth"}));
  // q of the three pairs within 0.45 m: 0.8, 0.4, 0.6. The fourth AUV has no link.
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(env.terms(0, i).communication, 0.6, 1e-9);
}

TEST(SwarmReward, CoordinationIsTheMeanBandDeviationOfTheSwarm) {
  double deviation = 0.0, error = 0.0;
  for (const double x : {0.0, 0.09, 0.27, 0.87}) {
    const double d = std::sqrt(x * x + 0.25);
    deviation += (d - 0.015) / 4.0;
    error += std::abs(d - 0.015) / 4.0;
  }
  const env::TestEnv paper = Line(env::Shipped("medium", "nominal", {"mode=truth"}));
  const env::TestEnv release = Line(env::Shipped("medium_release"));
  EXPECT_NEAR(paper.terms(0, 0).coordination, 1.0 - deviation / 0.8, 1e-9);
  EXPECT_NEAR(release.terms(0, 3).coordination, 1.0 - deviation / 0.8, 1e-9);
  // The "communication" of the release depends on the distance to the target, which is too large
  // here.
  EXPECT_EQ(release.terms(0, 0).communication, 0.0);
  EXPECT_NEAR(ReleaseCommunication(0.09, 0.45), 0.8, 1e-12);
}

/// Two AUVs are 0.012 m apart, half the separation distance. A third AUV is far from them.
env::TestEnv Crowd(const std::vector<std::string>& overrides) {
  std::vector<std::string> all = {"mode=truth", "agents=3", "contact.stiffness=0"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  env::TestEnv env(env::Shipped("medium", "nominal", all), env::VectorEnvOptions{});
  env.Place({{0.0, 0.0, 0.0}, {0.012, 0.0, 0.0}, {0.5, 0.0, 0.0}}, {{0.0, 0.3, 0.0}},
            {{0.0, 0.0, 0.0}});
  env.Step(Idle(env));
  return env;
}

TEST(SeparationReward, IsNothingByDefaultHoweverCrowded) {
  const env::TestEnv env = Crowd({});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(env.terms(0, i).separation, 0.0);
  for (const char* name : {"medium", "hard", "medium_release", "hard_release"}) {
    EXPECT_EQ(env::Shipped(name).reward.weights.separation, 0.0) << name;
  }
}

TEST(SeparationReward, CostsTheCrowdedAndOnlyThem) {
  const env::TestEnv off = Crowd({});
  const env::TestEnv on = Crowd({"reward.weights.separation=0.4"});
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(on.terms(0, i).separation, -0.5, 1e-9);
    EXPECT_NEAR(on.terms(0, i).total - off.terms(0, i).total, -0.2, 1e-9);
  }
  EXPECT_EQ(on.terms(0, 2).separation, 0.0);
  EXPECT_EQ(on.terms(0, 2).total, off.terms(0, 2).total);
}

}  // namespace
}  // namespace stg::task

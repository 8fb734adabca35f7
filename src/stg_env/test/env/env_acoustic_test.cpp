#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "acoustic_channel/channel/channel.hpp"
#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::env {
namespace {

/// No AUV senses a target that starts 0.25 m away or farther.
Scenario Blind() { return Short(Shipped("medium", "nominal", {"sensing.range_m=0.02"}), 200); }

TEST(Cue, IsWhatAnAgentThatNeverDetectsStartsFrom) {
  const Scenario s = Blind();
  double square = 0.0;
  int count = 0;
  TestEnv env(s);
  dynamics::World world(s.world, s.run);
  for (std::uint64_t round = 0; round < 100; ++round) {
    env.RestartAt(round);
    for (int e = 0; e < kEnvs; ++e) {
      world.Reset(0, env.seed(e), 0, s.world.reset.stage);
      const dynamics::Cue cue = world.InitialCue(0, 0, 0);
      const Vec3<double> noise = cue.p_WT - env.target(e, 0).p_WT;
      square += Dot(noise, noise);
      count += 3;
      for (int i = 0; i < 4; ++i) {
        const Vec3<double> r = cue.p_WT - env.vehicle(e, i).p_WB;
        const float* x = Row(env, e, i) + kTargetOffset;
        EXPECT_NEAR(x[0], r.x, 1e-6);
        EXPECT_NEAR(x[1], r.y, 1e-6);
        EXPECT_NEAR(x[2], r.z, 1e-6);
        EXPECT_EQ(Row(env, e, i)[kShownConfidence], 0.0F);
        // A cue says nothing about the target's velocity.
        for (int k = 0; k < 3; ++k) EXPECT_EQ(Row(env, e, i)[kTargetVelocity + k], 0.0F);
      }
    }
  }
  // Standard error of a standard deviation: sigma / sqrt(2 n).
  const double std_m = std::sqrt(square / count);
  EXPECT_NEAR(std_m, 0.05, 4.0 * 0.05 / std::sqrt(2.0 * count));
}

const std::vector<Vec3<double>> kSquare = {
    {-0.6, -0.1, 0.0}, {-0.6, 0.1, 0.0}, {-0.7, -0.1, 0.2}, {-0.7, 0.1, 0.2}};

/// Flies two swarms with the same start, cue and actions, and targets of different velocity. The
/// targets part by more than 0.4 m. True if all observations agree, bit for bit.
bool SameForBothTargets(const Scenario& s) {
  const VectorEnvOptions o;
  TestEnv a(s, o), b(s, o);
  a.Place(kSquare, {{0.3, 0.0, 0.0}}, {{0.02, 0.0, 0.0}});
  b.Place(kSquare, {{0.3, 0.0, 0.0}}, {{0.0, 0.03, 0.02}});
  bool same = true;
  for (int k = 0; k < 120; ++k) {
    auto actions = ActionsOf(a, o);
    for (float& v : actions) v *= 0.2F;
    a.Step(actions);
    b.Step(actions);
    const auto x = a.memory.observations, y = b.memory.observations;
    same = same && std::memcmp(x.data(), y.data(), x.size() * sizeof(float)) == 0;
  }
  EXPECT_GT(Norm(a.target(0, 0).p_WT - b.target(0, 0).p_WT), 0.4);
  return same;
}

TEST(NoLeak, ATargetBeyondEverybodysRangeChangesNoObservation) {
  Scenario s = Short(Shipped("medium"), 200);
  s.world.sensing.range_m = 0.25;
  EXPECT_TRUE(SameForBothTargets(s));
  // The observations do differ where the target is within range, and in truth mode.
  s.world.sensing.range_m = 1.5;
  EXPECT_FALSE(SameForBothTargets(s));
  s.world.sensing.range_m = 0.25;
  s.mode = InformationMode::kTruth;
  EXPECT_FALSE(SameForBothTargets(s));
}

/// Flies two swarms with different actions of AUV 3, which starts `gap` metres from AUV 0. True if
/// the observations of the others differ.
bool OthersNoticeTheFourth(InformationMode mode, double gap) {
  Scenario s = Short(Blind(), 200);
  s.mode = mode;
  s.channel.model = "range";
  s.channel.range_m = 0.4;
  s.agent.observation.graph = s.agent.observation.semantic = true;
  const VectorEnvOptions o;
  TestEnv a(s, o), b(s, o);
  std::vector<Vec3<double>> p = kSquare;
  p[3] = p[0] + Vec3<double>{gap, 0.0, 0.0};
  for (TestEnv* env : {&a, &b}) env->Place(p, {{0.0, 0.9, 0.9}}, {{0.0, 0.0, 0.0}});
  bool noticed = false;
  for (int k = 0; k < 40; ++k) {
    auto actions = ActionsOf(a, o);
    for (float& v : actions) v *= 0.05F;
    a.Step(actions);
    for (int e = 0; e < kEnvs; ++e) {
      for (int c = 0; c < 3; ++c) actions[static_cast<size_t>((e * 4 + 3) * 3 + c)] = 0.05F;
    }
    b.Step(actions);
    for (int i = 0; i < 3; ++i) {
      noticed = noticed || std::memcmp(Row(a, 0, i), Row(b, 0, i), 74 * sizeof(float)) != 0;
    }
  }
  return noticed;
}

TEST(NoLeak, ANeighbourBeyondTheChannelChangesNoObservation) {
  EXPECT_FALSE(OthersNoticeTheFourth(InformationMode::kAcoustic, 1.2));
  EXPECT_TRUE(OthersNoticeTheFourth(InformationMode::kAcoustic, 0.2));
  EXPECT_TRUE(OthersNoticeTheFourth(InformationMode::kTruth, 1.2));
}

TEST(Sharing, AnAgentOutOfSightLearnsTheTargetFromItsNeighbours) {
  Scenario s = Short(Shipped("medium"), 200);
  s.world.sensing.range_m = 0.3;
  s.channel.extended.loss_probability = 0.0;
  const VectorEnvOptions o;
  std::vector<Vec3<double>> p = kSquare;
  p[0] = {0.1, 0.0, 0.0};  // 0.2 m from the target; the other AUVs are more than 0.9 m away
  TestEnv env(s, o), alone(s, o);
  env.Place(p, {{0.3, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
  alone.Place(kSquare, {{0.3, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
  for (int k = 0; k < 30; ++k) {
    env.Step(Idle(env));
    alone.Step(Idle(alone));
  }
  for (int i = 1; i < 4; ++i) {
    const auto error = [&](const TestEnv& e) {
      return Norm(e.agent(0, i).knowledge().r_BT_W - (e.target(0, 0).p_WT - e.vehicle(0, i).p_WB));
    };
    EXPECT_LT(error(env), 0.005) << i;
    EXPECT_GT(error(alone), 0.01) << i;
    EXPECT_TRUE(env.agent(0, i).belief().observed);
    EXPECT_FALSE(alone.agent(0, i).belief().observed);
  }
}

struct Links {
  double delivered = 0.0, share = 0.0, quality = 0.0, shown = 0.0;
};

Links Fly(const std::string& scenario, const std::string& condition) {
  const Scenario s = Shipped(scenario, condition);
  VectorEnvOptions o;
  Links links;
  TestEnv env(s, o);
  env.Reset();
  double sent = 0.0;
  for (int k = 0; k < 300; ++k) {
    env.Step(Idle(env));
    for (int e = 0; e < kEnvs; ++e) {
      for (int i = 0; i < s.run.agents; ++i) {
        links.quality += env.agent(e, i).knowledge().mean_quality / (300.0 * kEnvs * s.run.agents);
        links.shown +=
            static_cast<double>(Row(env, e, i)[kGraph + 1]) / (300.0 * kEnvs * s.run.agents);
      }
    }
  }
  for (int e = 0; e < kEnvs; ++e) {
    const acoustics::ChannelTotals& t = env.channel(e).totals();
    links.delivered += static_cast<double>(t.delivered);
    sent += static_cast<double>(t.delivered + t.dropped);
  }
  links.share = links.delivered / sent;
  return links;
}

TEST(DegradedCommunication, ReallyDegradesTheLinks) {
  for (const char* stage : {"medium", "hard"}) {
    const Links good = Fly(stage, "nominal");
    for (const char* condition : {"degraded_communication", "combined_stress"}) {
      const Links bad = Fly(stage, condition);
      EXPECT_LT(bad.delivered, 0.4 * good.delivered) << stage;
      EXPECT_LT(bad.share, 0.7 * good.share) << stage;
      EXPECT_LT(bad.quality, 0.6 * good.quality) << stage;
      EXPECT_LT(bad.shown, 0.6 * good.shown) << stage;
    }
    EXPECT_GT(good.share, 0.6);
    // Conditions that are not about links do not change them.
    EXPECT_NEAR(Fly(stage, "limited_sensing").share, good.share, 0.1);
  }
}

TEST(PhysicalChannel, BringsTheAgentsOfTheFieldTheirNeighboursOverModems) {
  const Scenario s = Short(Shipped("physical"), 40);
  TestEnv env(s);
  env.Reset();
  for (int k = 0; k < 30; ++k) env.Step(Idle(env));
  for (int e = 0; e < kEnvs; ++e) {
    const acoustics::ChannelTotals& t = env.channel(e).totals();
    // Every AUV sends once in a decision, to three others.
    EXPECT_NEAR(static_cast<double>(t.delivered + t.dropped), 30.0 * 12.0, 24.0);
    EXPECT_GT(t.delivered, 30u * 6u);
    for (int i = 0; i < s.run.agents; ++i) {
      const agent::AgentView view = env.agent(e, i);
      EXPECT_GT(view.neighbours().known().size(), 0u);
      for (const int j : view.neighbours().known()) {
        const auto sight = view.sight(j);
        EXPECT_GT(sight.link_quality, 0.0);
        EXPECT_LT(sight.link_quality, 1.0) << "its news is older than now";
        EXPECT_LT(Norm(sight.p_WN - env.vehicle(e, j).p_WB), 25.0);
      }
    }
  }
}

TEST(PhysicalChannel, AModemWhoseFrameIsShorterThanAnAgentsPacketIsRefused) {
  for (const char* key :
       {"channel.physical.modem.profile=janus", "channel.physical.modem.packet_bytes=31"}) {
    std::string error;
    try {
      Shipped("physical", "nominal", {key});
    } catch (const UserError& e) {
      error = e.what();
    }
    EXPECT_NE(error.find("channel.physical.modem.packet_bytes"), std::string::npos) << key << error;
  }
}

TEST(AcousticReward, CommunicationIsTheQualityThatTheAgentsKnow) {
  VectorEnvOptions o;
  TestEnv env(Short(Shipped("medium"), 100), o);
  env.Reset();
  env.Step(Idle(env));
  for (int k = 0; k < 30; ++k) env.Step(Idle(env));
  for (int e = 0; e < kEnvs; ++e) {
    double mean = 0.0;
    for (int i = 0; i < 4; ++i) mean += env.agent(e, i).knowledge().mean_quality / 4.0;
    EXPECT_GT(mean, 0.0);
    EXPECT_LE(mean, 1.0);
    EXPECT_NEAR(env.terms(e, 2).communication, mean, 1e-12);
  }
}

TEST(AcousticMode, RewardAndCriticStateComeFromTheTruth) {
  // Under tau6 both modes fly the same way, because no controller is between. Only the input of the
  // actor differs.
  Scenario s = Short(Shipped("medium", "nominal", {"control.interface=tau6"}), 60);
  Scenario t = s;
  t.mode = InformationMode::kTruth;
  const VectorEnvOptions o;
  TestEnv a(s, o), b(t, o);
  a.Reset();
  b.Reset();
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(a.memory.states, b.memory.states) << k;
    a.Step(ActionsOf(a, o));
    b.Step(ActionsOf(b, o));
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(a.terms(0, i).track, b.terms(0, i).track) << k;
      EXPECT_EQ(a.terms(0, i).observation, b.terms(0, i).observation) << k;
    }
  }
  EXPECT_NE(a.memory.observations, b.memory.observations);
}

}  // namespace
}  // namespace stg::env

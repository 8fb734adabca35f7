#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "env/env_fixture.hpp"

namespace stg::env {
namespace {

const InformationMode kModes[] = {InformationMode::kTruth, InformationMode::kAcoustic};

TEST(Observation, EveryCombinationOfBlocksIsThatPartOfTheFullOne) {
  for (const auto mode : kModes) {
    Scenario full = Short(Shipped("medium"), 50);
    full.mode = mode;
    const VectorEnvOptions o;
    for (int options = 0; options < 8; ++options) {
      Scenario s = full;
      s.agent.observation.tracking = (options & 1) != 0;
      s.agent.observation.semantic = (options & 2) != 0;
      s.agent.observation.graph = (options & 4) != 0;
      TestEnv a(full, o), b(s, o);
      ASSERT_EQ(a.observation_size(), 74);
      ASSERT_EQ(b.observation_size(), 51 + ((options & 1) != 0 ? 8 : 0) +
                                          ((options & 2) != 0 ? 9 : 0) +
                                          ((options & 4) != 0 ? 6 : 0));
      a.Reset();
      b.Reset();
      for (int k = 0; k < 15; ++k) {
        a.Step(ActionsOf(a, o));
        b.Step(ActionsOf(b, o));
      }
      for (int e = 0; e < kEnvs; ++e) {
        for (int i = 0; i < 4; ++i) {
          const float* x = Row(a, e, i);
          std::vector<float> expected(x, x + kTracking);
          if (s.agent.observation.tracking)
            expected.insert(expected.end(), x + kTracking, x + kSemantic);
          if (s.agent.observation.semantic)
            expected.insert(expected.end(), x + kSemantic, x + kGraph);
          if (s.agent.observation.graph) expected.insert(expected.end(), x + kGraph, x + 74);
          const float* y = Row(b, e, i);
          EXPECT_EQ(expected, std::vector<float>(y, y + b.observation_size())) << options;
        }
      }
    }
  }
}

TEST(Observation, AnySwarmRunsWithFiniteBoundedNumbersAndOneSize) {
  struct Case {
    int agents, targets;
  };
  for (const auto mode : kModes) {
    for (const auto interface :
         {dynamics::ActionInterface::kVelocity3, dynamics::ActionInterface::kTau6}) {
      for (const Case c : {Case{1, 1}, Case{2, 1}, Case{2, 2}, Case{5, 2}, Case{20, 1}}) {
        Scenario s = Short(Shipped("medium"), 25);
        s.mode = mode;
        s.world.control.interface = interface;
        s.run.agents = c.agents;
        s.world.target.count = c.targets;
        s.world.reset.min_separation_m = 0.03;
        const VectorEnvOptions o;
        TestEnv env(s, o);
        EXPECT_EQ(env.observation_size(), 74);
        EXPECT_EQ(env.state_size(), 19 * c.agents + 6 * c.targets);
        EXPECT_EQ(env.action_size(), interface == dynamics::ActionInterface::kTau6 ? 6 : 3);
        env.Reset();
        for (int k = 0; k < 60; ++k) {  // longer than two episodes
          env.Step(ActionsOf(env, o));
          for (const float v : env.memory.observations) ASSERT_LE(std::abs(v), 2.0F + 1e-6F);
          for (const float v : env.memory.states) ASSERT_LE(std::abs(v), 4.0F);
          for (const float r : env.memory.team_rewards) ASSERT_LE(std::abs(r), 2.0F);
        }
        for (const auto& item : env.metrics(0).Items()) {
          EXPECT_TRUE(std::isfinite(item.second)) << item.first;
        }
      }
    }
  }
}

/// Offsets of the neighbours of AUV i in one environment, in order of index or of distance.
std::vector<Vec3<double>> Offsets(const TestEnv& env, int e, int i, bool by_distance) {
  std::vector<Vec3<double>> offsets;
  for (int j = 0; j < env.agents(); ++j) {
    if (j == i) continue;
    offsets.push_back(env.vehicle(e, j).p_WB - env.vehicle(e, i).p_WB);
  }
  if (by_distance) {
    std::sort(offsets.begin(), offsets.end(),
              [](const auto& a, const auto& b) { return Norm(a) < Norm(b); });
  }
  return offsets;
}

void ExpectNeighbours(const TestEnv& env, bool by_distance) {
  for (int e = 0; e < kEnvs; ++e) {
    for (int i = 0; i < env.agents(); ++i) {
      const auto offsets = Offsets(env, e, i, by_distance);
      const float* shown = Row(env, e, i) + kNeighbours;
      for (size_t slot = 0; slot < 3; ++slot, shown += 3) {
        const Vec3<double> r = slot < offsets.size() ? offsets[slot] : Vec3<double>{};
        EXPECT_NEAR(shown[0], r.x, 1e-6) << "AUV " << i << ", slot " << slot;
        EXPECT_NEAR(shown[1], r.y, 1e-6);
        EXPECT_NEAR(shown[2], r.z, 1e-6);
      }
    }
  }
}

TEST(Neighbours, TheThreeNearestInOrderEqualBruteForce) {
  for (const int agents : {1, 2, 3, 4, 20}) {
    Scenario s = Short(Shipped("medium"), 50);
    s.mode = InformationMode::kTruth;
    s.run.agents = agents;
    s.world.reset.min_separation_m = 0.03;
    const VectorEnvOptions o;
    TestEnv env(s, o);
    env.Reset();
    for (int k = 0; k < 30; ++k) {
      ExpectNeighbours(env, true);
      env.Step(ActionsOf(env, o));
    }
  }
}

TEST(Neighbours, IndexOrderShowsTheFirstThreeOthers) {
  for (const int agents : {1, 2, 4, 6}) {
    Scenario s = Short(Shipped("medium_release"), 50);
    s.run.agents = agents;
    s.world.reset.min_separation_m = 0.03;
    const VectorEnvOptions o;
    TestEnv env(s, o);
    env.Reset();
    for (int k = 0; k < 5; ++k) env.Step(ActionsOf(env, o));
    ExpectNeighbours(env, false);
  }
}

TEST(Observation, InTruthModeStatesGeometryInItsDocumentedPlaces) {
  Scenario s = Short(Shipped("medium", "nominal", {"mode=truth", "agents=2"}), 50);
  TestEnv env(s, VectorEnvOptions{});
  env.Place({{0.1, 0.2, -0.3}, {0.1, 0.2, 0.0}}, {{0.4, 0.2, -0.3}}, {{0.02, -0.01, 0.03}});
  const float* x = Row(env, 0, 0);
  const auto expect = [&](int first, const std::vector<double>& values) {
    for (size_t k = 0; k < values.size(); ++k) {
      EXPECT_NEAR(x[static_cast<size_t>(first) + k], values[k], 1e-6)
          << static_cast<size_t>(first) + k;
    }
  };
  expect(0, {0.1, 0.2, -0.3});                // own position
  expect(3, {0.0, 1.0, 0.0, 1.0, 0.0, 1.0});  // level
  expect(9, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0});  // at rest
  expect(15, {0.3, 0.0, 0.0});                // target offset
  expect(18, {0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  expect(27, {0.9, 0.8, 0.7});                        // room to the walls
  expect(30, {0.02 / 1.5, -0.01 / 0.5, 0.03 / 0.5});  // target velocity
  expect(33, {0.02 / 1.5, -0.01 / 0.5, 0.03 / 0.5});  // relative velocity
  expect(36, {0.3, 0.0, 0.0});                        // target offset, body axes
  expect(39, {0.02 / 1.5, -0.01 / 0.5, 0.03 / 0.5});
  expect(42, {1.0, 0.0, 0.0});                 // line of sight
  expect(45, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0});  // last force and moment
  // d, e, progress, closing, mean e, c, lost, lost steps.
  expect(51, {0.25, 0.285 / 0.8, 0.0, -0.25, 0.285 / 0.8, 1.0 / 3.0, 0.0, 0.0});
  expect(59, {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0});  // search, low, closest
  // One neighbour at 0.3 m: q = 1/3; its error sqrt(0.18) - 0.015.
  const double q = 1.0 / 3.0, e1 = (std::sqrt(0.18) - 0.015) / 0.8;
  expect(68, {1.0, q, q, e1, e1 - 0.285 / 0.8, 0.0});
}

TEST(Observation, LostStepsCountUpAndTheReleaseCountsOneTooMany) {
  for (const bool release : {false, true}) {
    Scenario s = Short(Shipped("medium_release", "nominal", {"agents=1"}), 50);
    s.agent.observation.release_bookkeeping = release;
    TestEnv env(s, VectorEnvOptions{});
    // The target moves 1 mm a step. It is beyond 0.65 m, and so lost, from decision 5 on.
    env.Place({{0.0, 0.0, 0.0}}, {{0.6455, 0.0, 0.0}}, {{0.01, 0.0, 0.0}});
    for (int k = 1; k <= 40; ++k) {
      env.Step(Idle(env));
      const int lost = std::max(0, k - 4);
      const int shown = release && lost > 0 ? lost + 1 : lost;
      EXPECT_NEAR(Row(env, 0, 0)[kTracking + 7], std::min(25, shown) / 25.0, 1e-6) << k;
      EXPECT_EQ(Row(env, 0, 0)[kTracking + 6], lost > 0 ? 1.0F : 0.0F);
    }
  }
}

TEST(Observation, ReleaseBookkeepingHidesProgress) {
  for (const bool release : {false, true}) {
    Scenario s = Short(Shipped("medium_release", "nominal", {"agents=1"}), 50);
    s.agent.observation.release_bookkeeping = release;
    TestEnv env(s, VectorEnvOptions{});
    env.Place({{0.0, 0.0, 0.0}}, {{0.4, 0.0, 0.0}}, {{-0.04, 0.0, 0.0}});
    for (int k = 1; k <= 3; ++k) {
      env.Step(Idle(env));
      // The target comes 4 mm closer in a step, which is a tenth of the progress scale.
      EXPECT_NEAR(Row(env, 0, 0)[kTracking + 2], release ? 0.0 : 0.1, 1e-5);
      EXPECT_EQ(Row(env, 0, 0)[kSemantic + agent::kApproach], release ? 0.0F : 1.0F);
    }
  }
}

TEST(CriticState, HoldsEveryAuvThenEveryTarget) {
  Scenario s = Short(Shipped("medium", "nominal", {"agents=3", "target.count=2"}), 50);
  TestEnv env(s, VectorEnvOptions{});
  env.Place({{0.1, 0.0, 0.0}, {0.0, 0.2, 0.0}, {0.0, 0.0, 0.3}},
            {{0.4, 0.1, 0.0}, {0.0, 0.21, 0.0}}, {{0.03, 0.0, 0.0}, {0.0, 0.02, 0.0}});
  const float* x = env.memory.state(kEnvs - 1);
  ASSERT_EQ(env.state_size(), 69);
  const auto expect = [&](int first, const std::vector<double>& values) {
    for (size_t k = 0; k < values.size(); ++k) {
      EXPECT_NEAR(x[static_cast<size_t>(first) + k], values[k], 1e-6)
          << static_cast<size_t>(first) + k;
    }
  };
  // AUV i follows target i modulo 2. The offset comes first, then twenty times the offset, clipped.
  expect(0, {0.3, 0.1, 0.0, 1.0, 1.0, 0.0, 0.02, 0.0, 0.0});
  expect(19, {0.0, 0.01, 0.0, 0.0, 0.2, 0.0, 0.0, 0.04, 0.0});
  expect(38, {0.4, 0.1, -0.3, 1.0, 1.0, -1.0});
  expect(19 + 15, {-0.1, 0.0, 0.0, 1.0});  // d - d*, progress, lost, upright
  expect(57, {0.4, 0.1, 0.0, 0.4, 0.0, 0.0, 0.0, 0.21, 0.0, 0.0, 0.8, 0.0});
}

TEST(Tau6, ASurgeForceMovesTheBowAndIsNotSmoothed) {
  for (const auto mode : kModes) {
    Scenario s = Short(Shipped("medium"), 50);
    s.mode = mode;
    s.world.control.interface = dynamics::ActionInterface::kTau6;
    TestEnv env(s, VectorEnvOptions{});
    env.Reset();
    std::vector<float> actions = Idle(env);
    for (size_t k = 0; k < actions.size(); k += 6) actions[k] = 0.5F;
    env.Step(actions);
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(Row(env, 0, i)[kPreviousTau], 0.5F);
      EXPECT_GT(env.vehicle(0, i).v_WB_B.x, 0.0);
      EXPECT_NEAR(env.vehicle(0, i).v_WB_B.y, 0.0, 1e-6);
    }
  }
}

}  // namespace
}  // namespace stg::env

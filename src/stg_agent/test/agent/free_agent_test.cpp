// An agent that keeps a belief of every target and chooses the target that it follows.

#include <gtest/gtest.h>

#include "agent/agent_fixture.hpp"
#include "stg_agent/controllers/assign.hpp"
#include "stg_agent/entities/entity_pilot.hpp"

namespace stg::agent {
namespace {

AgentModel FreeModel(int agents, int targets) {
  AgentModel s;
  s.run.agents = agents;
  s.target.count = targets;
  s.task.assignment = Assignment::kFree;
  s.track.neighbour_max_age_s = 100.0;
  return s;
}

dynamics::Cue CueOf(int target, const Vec3<double>& p_WT) {
  dynamics::Cue cue = CueAt(p_WT, 0.01);
  cue.target = target;
  return cue;
}

struct Flown {
  explicit Flown(const AgentModel& s, int id)
      : agent(s, id), row(agent.model().observation_size()) {}

  void Start(const std::vector<Vec3<double>>& targets) {
    agent.Reset(0, CueOf(agent.target(), targets[static_cast<std::size_t>(agent.target())]));
    for (std::size_t k = 0; k < targets.size(); ++k) {
      if (static_cast<int>(k) != agent.target())
        agent.AddCue(CueOf(static_cast<int>(k), targets[k]));
    }
  }
  void Observe(int step, const Vec3<double>& p) { agent.Observe(Nav(step * kStep, p), row.data()); }

  Agent agent;
  std::vector<float> row;
};

const std::vector<Vec3<double>> kTargets{{0.5, 0.0, 0.0}, {-0.5, 0.0, 0.0}, {0.0, 0.5, 0.0}};

TEST(FreeAgents, KnowEveryTargetAndFollowTheirOwnFirst) {
  Flown f(FreeModel(4, 3), 1);
  f.Start(kTargets);
  f.Observe(0, {0.0, 0.0, 0.0});
  EXPECT_EQ(f.agent.target(), 1);
  EXPECT_NEAR(f.agent.knowledge().r_BT_W.x, -0.5, 1e-12);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(Norm(f.agent.view().belief(k).p_WT - kTargets[static_cast<std::size_t>(k)]), 0.0,
                1e-12);
  }
}

TEST(FreeAgents, FollowAnotherTargetFromTheNextDecisionOnWithoutAJumpInProgress) {
  Flown f(FreeModel(4, 3), 0);
  f.Start(kTargets);
  f.Observe(0, {0.0, 0.0, 0.0});
  f.agent.view().Follow(2);
  EXPECT_EQ(f.agent.target(), 0);
  f.Observe(1, {0.0, 0.1, 0.0});
  EXPECT_EQ(f.agent.target(), 2);
  EXPECT_NEAR(f.agent.knowledge().distance, 0.4, 1e-9);
  EXPECT_EQ(f.agent.knowledge().previous_distance, f.agent.knowledge().distance);
  f.Observe(2, {0.0, 0.2, 0.0});
  EXPECT_NEAR(f.agent.knowledge().previous_distance, 0.4, 1e-9);
  f.agent.view().Follow(7);  // this target does not exist
  f.Observe(3, {0.0, 0.2, 0.0});
  EXPECT_EQ(f.agent.target(), 2);
  f.Start(kTargets);
  f.Observe(0, {0.0, 0.0, 0.0});
  EXPECT_EQ(f.agent.target(), 0) << "a new episode forgets the choice";
}

TEST(FreeAgents, TakeDetectionsOfEveryTargetAndModuloOnesDoNot) {
  for (const bool free : {true, false}) {
    AgentModel s = FreeModel(4, 3);
    if (!free) s.task.assignment = Assignment::kModulo;
    Flown f(s, 0);
    f.agent.Reset(0, CueOf(0, kTargets[0]));
    f.agent.Detect({0, 2, kTargets[2], 0.001});
    f.Observe(0, {0.0, 0.0, 0.0});
    EXPECT_EQ(f.agent.view().beliefs(), free ? 3 : 1);
    if (free) {
      EXPECT_TRUE(f.agent.view().belief(2).observed);
    }
    EXPECT_FALSE(f.agent.view().belief(0).observed);
  }
}

TEST(FreeAgents, ShowARowOfEveryTargetTheFollowedOneFirst) {
  Flown f(FreeModel(4, 3), 0);
  f.Start(kTargets);
  f.Observe(0, {-0.3, 0.0, 0.0});
  Entities e;
  BuildEntities(f.agent.view(), &e);
  ASSERT_EQ(e.targets, 3);
  EXPECT_EQ(e.target_of_row[0], 0);
  EXPECT_EQ(e.target_of_row[1], 1) << "nearer than target 2";
  EXPECT_EQ(e.target_of_row[2], 2);
  EXPECT_EQ(e.target[0][39], 1.0F);
  EXPECT_EQ(e.target[1][39], 0.0F);
  EXPECT_NEAR(e.target[1][2], EntityScales(FreeModel(4, 3)).Far(0.2), 1e-6);
}

TEST(FreeAgents, FollowTheTargetWhoseRowAPolicyChooses) {
  Flown f(FreeModel(4, 3), 0);
  f.Start(kTargets);
  f.Observe(0, {-0.3, 0.0, 0.0});
  Entities e;
  BuildEntities(f.agent.view(), &e);
  TakeChoice(f.agent.view(), e, 1);
  EXPECT_FALSE(f.agent.view().memory().search);
  EXPECT_EQ(f.agent.target(), 0);
  f.Observe(1, {-0.3, 0.0, 0.0});
  EXPECT_EQ(f.agent.target(), 1);
  BuildEntities(f.agent.view(), &e);
  EXPECT_EQ(e.target_of_row[0], 1);
  TakeChoice(f.agent.view(), e, e.targets);
  EXPECT_TRUE(f.agent.view().memory().search);
  f.Observe(2, {-0.3, 0.0, 0.0});
  EXPECT_EQ(f.agent.target(), 1) << "a search changes no target";
}

/// The report of a neighbour that follows a target. It is heard at once.
NeighbourState Following(int source, int step, const Vec3<double>& p_W, int target) {
  NeighbourState n = Report(source, step * kStep, p_W);
  n.has_target = true;
  n.target = target;
  n.target_stamp = n.generation;
  n.p_WT = kTargets[static_cast<std::size_t>(target)];
  n.target_std = 0.01;
  return n;
}

TEST(Assign, NobodyGoesFarWhereSomebodyIsNear) {
  AgentModel s = FreeModel(3, 3);
  s.vehicle.max_velocity_mps = {0.5, 0.5, 0.5};
  AssignOptions o;
  o.fast_mps = 0.5;
  o.hysteresis_s = 0.0;
  const Assign law(o);
  Flown f(s, 0);
  f.Start(kTargets);
  f.agent.Receive(Heard(s, Following(1, 0, {0.4, 0.0, 0.0}, 1), 0));
  f.agent.Receive(Heard(s, Following(2, 0, {0.0, 0.3, 0.0}, 2), 0));
  f.Observe(0, {-0.4, 0.0, 0.0});
  EXPECT_EQ(law.Choose(f.agent.view()), 1);
}

TEST(Assign, AnotherTargetMustBeBetterByTheHysteresis) {
  AgentModel s = FreeModel(2, 2);
  s.target.max_speed_mps = 0.05;
  const std::vector<Vec3<double>> targets{{0.5, 0.0, 0.0}, {-0.5, 0.0, 0.0}};
  for (const double hysteresis_s : {0.0, 60.0}) {
    AssignOptions o;
    o.fast_mps = 0.5;
    o.hysteresis_s = hysteresis_s;
    Flown f(s, 0);
    f.Start(targets);
    NeighbourState n = Following(1, 0, {0.1, 0.0, 0.0}, 1);
    n.p_WT = targets[1];
    f.agent.Receive(Heard(s, n, 0));
    f.Observe(0, {-0.1, 0.0, 0.0});
    EXPECT_EQ(Assign(o).Choose(f.agent.view()), hysteresis_s > 0.0 ? 0 : 1);
  }
}

TEST(Assign, EveryTargetHasTwoBeforeAnotherHasThree) {
  AgentModel s = FreeModel(4, 2);
  const std::vector<Vec3<double>> targets{{0.5, 0.0, 0.0}, {-0.5, 0.0, 0.0}};
  const Assign law((AssignOptions()));
  // All four follow target 0. The AUV that is nearest to the other target goes there.
  std::vector<int> chosen;
  for (int id = 0; id < 4; ++id) {
    Flown f(s, id);
    f.Start(targets);
    for (int j = 0; j < 4; ++j) {
      NeighbourState n = Following(j, 0, {0.4 - 0.1 * j, 0.0, 0.0}, 0);
      if (j != id) f.agent.Receive(Heard(s, n, 0));
    }
    f.Observe(0, {0.4 - 0.1 * id, 0.0, 0.0});
    f.agent.view().Follow(0);
    f.Observe(1, {0.4 - 0.1 * id, 0.0, 0.0});
    chosen.push_back(law.Choose(f.agent.view()));
  }
  EXPECT_EQ(chosen, (std::vector<int>{0, 0, 1, 1}));
}

/// One AUV for each target is enough here. The near AUV can leave its target to the second one, so
/// that neither waits for the third, which is far away from both.
TEST(Assign, TheWayOfASurplusAuvMattersLittle) {
  AgentModel s = FreeModel(3, 2);
  const std::vector<Vec3<double>> targets{{0.0, 0.0, 0.0}, {0.35, 0.0, 0.0}};
  for (const double extra : {1.0, 0.2}) {
    AssignOptions o;
    o.fast_mps = 0.5;
    o.hysteresis_s = 0.0;
    o.least = 1;
    o.extra = extra;
    Flown f(s, 0);
    f.Start(targets);
    f.agent.Receive(Heard(s, Following(1, 0, {-0.2, 0.0, 0.0}, 0), 0));
    f.agent.Receive(Heard(s, Following(2, 0, {0.0, 0.9, 0.0}, 1), 0));
    f.Observe(0, {0.1, 0.0, 0.0});
    EXPECT_EQ(Assign(o).Choose(f.agent.view()), extra == 1.0 ? 0 : 1);
  }
}

TEST(Members, WhoHasLeftForgetsAndStandsStill) {
  AgentModel s = FreeModel(2, 1);
  s.task.assignment = Assignment::kModulo;
  s.control.max_delta = s.control.smoothing = 0.0;
  s.fleet.leave = {{0.2, 0.0}};
  s.fleet.join = {{0.4, 0.0}};
  Flown f(s, 0);
  f.agent.Reset(0, CueAt(kTargets[0]));
  const float action[3] = {1.0F, 0.5F, 0.0F};
  for (int step = 0; step < 6; ++step) {
    f.agent.Detect({step * kStep, 0, kTargets[0], 0.001});
    f.Observe(step, {});
    const bool away = step == 2 || step == 3;
    EXPECT_EQ(f.agent.present(), !away) << step;
    EXPECT_EQ(Norm(f.agent.Act(action).cmd_vel_W) == 0.0, away) << step;
    // The detection of step 4 comes before the AUV has joined in that step.
    EXPECT_EQ(f.agent.belief().started, step != 4) << step;
  }
}

}  // namespace
}  // namespace stg::agent

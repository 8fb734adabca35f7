#include "stg_agent/agent/agent.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "agent/agent_fixture.hpp"
#include "auv_dynamics/control/control.hpp"
#include "stg_agent/controllers/controller.hpp"

namespace stg::agent {
namespace {

const float kZero[6] = {};

/// Observes, and does not use the numbers.
void Look(Agent* agent, const dynamics::NavState& nav) {
  float observation[128];
  agent->Observe(nav, observation);
}

TEST(Agent, StartsFromTheCueWithNoConfidence) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.2, 0.0, 0.0}));
  Look(&agent, Nav(0, {}));
  const Knowledge<double>& k = agent.knowledge();
  EXPECT_DOUBLE_EQ(k.distance, 0.2);
  EXPECT_DOUBLE_EQ(k.previous_distance, 0.2);
  EXPECT_DOUBLE_EQ(k.error, 0.2 - 0.015);
  EXPECT_EQ(k.confidence, 0.0) << "a cue is no observation";
  EXPECT_EQ(k.lost, 0.0);
  agent.Detect({0, 0, {0.2, 0.0, 0.0}, 0.0});
  Look(&agent, Nav(0, {}));
  EXPECT_NEAR(k.confidence, 1.0 - 0.2 / 0.45, 1e-4);
}

TEST(Agent, ConfidenceEndsWithTheFreshnessOfTheLastObservation) {
  const AgentModel s;  // freshness 2 s
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.2, 0.0, 0.0}));
  agent.Detect({0, 0, {0.2, 0.0, 0.0}, 0.0});
  for (int k = 0; k <= 25; ++k) {
    Look(&agent, Nav(k * kStep, {}));
    EXPECT_EQ(agent.knowledge().confidence > 0.0, k <= 20) << k;
  }
}

TEST(Agent, ConfidenceAlsoRestsOnWhatANeighbourSees) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.2, 0.0, 0.0}));
  NeighbourState n;
  n.source = 1;
  n.has_target = true;
  n.p_WT = {0.21, 0.0, 0.0};
  n.target_std = 0.001;
  agent.Receive(Heard(s, n, kStep));
  Look(&agent, Nav(kStep, {}));
  EXPECT_NEAR(agent.knowledge().distance, 0.21, 1e-3);
  EXPECT_NEAR(agent.knowledge().confidence, 1.0 - 0.21 / 0.45, 5e-3);
}

TEST(Agent, LosesAnUnseenTargetAndCountsTheSteps) {
  AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.1, 0.0, 0.0}));
  int lost_steps = 0;
  for (int k = 0; k < 400; ++k) {
    Look(&agent, Nav(k * kStep, {}));
    const bool uncertain = agent.estimate().position_std_m() > s.track.lost_std_m;
    EXPECT_EQ(agent.lost(), uncertain);
    lost_steps = uncertain ? lost_steps + 1 : 0;
    EXPECT_EQ(agent.knowledge().lost_steps, lost_steps);
  }
  EXPECT_GT(lost_steps, 0);
  agent.Detect({400 * kStep, 0, {0.1, 0.0, 0.0}, 0.0});
  Look(&agent, Nav(400 * kStep, {}));
  EXPECT_FALSE(agent.lost());
  EXPECT_EQ(agent.knowledge().lost_steps, 0.0);
}

TEST(Agent, ATargetBeyondTheLostDistanceIsLost) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.649, 0.0, 0.0}, 0.001));
  Look(&agent, Nav(0, {}));
  EXPECT_FALSE(agent.lost());
  agent.Reset(0, CueAt({0.651, 0.0, 0.0}, 0.001));
  Look(&agent, Nav(0, {}));
  EXPECT_TRUE(agent.lost());
}

TEST(Agent, RemembersDistancesAndErrorsPerDecision) {
  const AgentModel s;  // window 5
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.5, 0.0, 0.0}, 0.001));
  std::vector<double> errors;
  double previous = 0.5;
  for (int k = 0; k < 9; ++k) {
    Look(&agent, Nav(k * kStep, {0.03 * k, 0.0, 0.0}, {0.3, 0.0, 0.0}));
    const Knowledge<double>& now = agent.knowledge();
    EXPECT_DOUBLE_EQ(now.previous_distance, previous);
    EXPECT_NEAR(now.distance, 0.5 - 0.03 * k, 1e-12);
    EXPECT_NEAR(now.closing, 0.3, 1e-12);
    errors.push_back(now.error);
    double sum = 0.0;
    const std::size_t first = errors.size() > 5 ? errors.size() - 5 : 0;
    for (std::size_t j = first; j < errors.size(); ++j) sum += errors[j];
    EXPECT_NEAR(now.mean_error, sum / static_cast<double>(errors.size() - first), 1e-12);
    previous = now.distance;
  }
}

TEST(Agent, GraphCountsUnheardNeighboursAsNoLink) {
  const AgentModel s;  // three others
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.2, 0.0, 0.0}));
  Look(&agent, Nav(0, {}));
  EXPECT_EQ(agent.knowledge().mean_quality, 0.0);
  EXPECT_EQ(agent.knowledge().mean_neighbour_error, agent.knowledge().error);
  EXPECT_EQ(agent.knowledge().closest, 1.0);
  NeighbourState n;
  n.source = 2;
  n.p_W = {0.15, 0.0, 0.0};
  n.tracking_error = 0.4;
  agent.Receive(Heard(s, n, 0));
  Look(&agent, Nav(0, {}));
  const Knowledge<double>& k = agent.knowledge();
  const double q = agent.view().sight(2).link_quality;
  EXPECT_GT(q, 0.7);
  EXPECT_DOUBLE_EQ(k.best_quality, q);
  EXPECT_DOUBLE_EQ(k.mean_quality, q / 3.0);
  EXPECT_DOUBLE_EQ(k.effective_fraction, 1.0 / 3.0);
  EXPECT_NEAR(k.mean_neighbour_error, 0.4, 1e-3);
  EXPECT_EQ(k.closest, 0.0) << "the neighbour is 0.05 from the target";
}

TEST(Agent, NeighbourSlotsAreNearestFirstOrByIndex) {
  AgentModel s;
  s.run.agents = 5;
  const double x[] = {0.4, 0.0, 0.1, 0.3, 0.2};
  for (const NeighbourOrder order : {NeighbourOrder::kNearest, NeighbourOrder::kIndex}) {
    s.observation.order = order;
    Agent agent(s, 1);
    agent.Reset(0, CueAt({}));
    for (const int j : {0, 2, 4}) {
      NeighbourState n;
      n.source = j;
      n.p_W = {x[j], 0.0, 0.0};
      agent.Receive(Heard(s, n, 0));
    }
    Look(&agent, Nav(0, {}));
    const auto& slots = agent.knowledge().neighbour;
    const bool nearest = order == NeighbourOrder::kNearest;
    EXPECT_NEAR(slots[0].x, nearest ? 0.1 : 0.4, 1e-4);
    EXPECT_NEAR(slots[1].x, nearest ? 0.2 : 0.1, 1e-4);
    EXPECT_NEAR(slots[2].x, nearest ? 0.4 : 0.0, 1e-4) << "0 where auv 3 was not heard";
  }
}

TEST(Agent, FractionIsWhatTheControllerNodeComputesAndIsObservedNext) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.2, 0.1, 0.0}));
  std::vector<float> observation;
  float last[6] = {};
  for (const Input& in : RandomEpisode(s, 0, 50, 3)) {
    const AgentOutput out = Drive(&agent, in, &observation);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(observation[static_cast<std::size_t>(45 + k)], last[k]);
    double fraction[6];
    dynamics::VelocityController(s.control, s.vehicle, out.cmd_vel_W, in.nav, fraction);
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(out.fraction[k], fraction[k]);
      last[k] = static_cast<float>(fraction[k]);
    }
  }
}

TEST(Agent, ActionIsRateLimitedSmoothedAndScaledToSpeed) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({}));
  const float full[] = {5.0F, -1.0F, 0.1F};
  Look(&agent, Nav(0, {}));
  const AgentOutput out = agent.Act(full);
  // The AUV is at rest. The change is limited to 0.35, and 0.8 of this is taken.
  EXPECT_NEAR(out.action[0], 0.28, 1e-12);
  EXPECT_NEAR(out.action[1], -0.28, 1e-12);
  EXPECT_NEAR(out.cmd_vel_W.x, 0.28 * 1.5, 1e-12);
  EXPECT_NEAR(out.cmd_vel_W.y, -0.28 * 0.5, 1e-12);
  EXPECT_NEAR(out.cmd_vel_W.z, 0.08 * 0.5, 1e-8);
}

TEST(Agent, Tau6ActionsAreTheForceFractions) {
  AgentModel s;
  s.control.interface = dynamics::ActionInterface::kTau6;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({}));
  Look(&agent, Nav(0, {}));
  const float action[] = {0.5F, -0.25F, 2.0F, -2.0F, 0.125F, 0.0F};
  const AgentOutput out = agent.Act(action);
  const double expected[] = {0.5, -0.25, 1.0, -1.0, 0.125, 0.0};
  for (int k = 0; k < 6; ++k) EXPECT_EQ(out.fraction[k], expected[k]);
  EXPECT_EQ(Norm(out.cmd_vel_W), 0.0);
}

TEST(Agent, OneThatComesLateFindsTheCueAsUncertainAsItHasBecome) {
  const AgentModel s;
  for (int late = 1; late <= 7; ++late) {
    Agent always(s, 2), restarted(s, 2);
    always.Reset(0, CueAt({0.2, 0.0, 0.0}));
    restarted.Reset(0, CueAt({0.2, 0.0, 0.0}));
    for (int k = 0; k < 20; ++k) {
      Look(&always, Nav(k * kStep, {}));
      always.Act(kZero);
      if (k < late) continue;
      Look(&restarted, Nav(k * kStep, {}));
      restarted.Act(kZero);
      EXPECT_NEAR(restarted.estimate().position_std_m(), always.estimate().position_std_m(), 1e-12);
      EXPECT_EQ(restarted.knowledge().distance, 0.2);
    }
  }
}

TEST(Agent, PacketTellsOwnStateAndTheEstimateAsOfItsLastObservation) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.2, 0.0, 0.0}));
  const PacketCodec codec(s);
  for (int k = 0; k <= 10; ++k) {
    if (k < 8) agent.Detect({k * kStep, 0, {0.2 + 0.0005 * k, 0.0, 0.0}, 0.0});
    Look(&agent, Nav(k * kStep, {0.01 * k, 0.1, 0.0}, {0.1, 0.0, 0.0}));
    agent.Act(kZero);
    if (k != 10) continue;
    const Packet packet = agent.MakePacket();
    const NeighbourState n = codec.Decode(packet.data(), packet.size(), k * kStep);
    EXPECT_EQ(n.source, 0);
    EXPECT_EQ(n.generation, k * kStep);
    EXPECT_NEAR(n.p_W.x, 0.1, 1e-4);
    EXPECT_NEAR(n.v_W.x, 0.1, 1e-3);
    EXPECT_NEAR(n.tracking_error, agent.knowledge().error, 1e-3);
    EXPECT_EQ(n.phase, agent.task().phase);
    EXPECT_TRUE(n.has_target);
    EXPECT_EQ(n.target_stamp, 7 * kStep);
    EXPECT_NEAR(n.p_WT.x, 0.2035, 3e-4);
    EXPECT_FALSE(n.saturated);
  }
}

TEST(Agent, SaysNothingOfATargetItKnowsFromTheCueOnly) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.2, 0.0, 0.0}));
  Look(&agent, Nav(0, {}));
  agent.Act(kZero);
  const Packet packet = agent.MakePacket();
  EXPECT_FALSE(PacketCodec(s).Decode(packet.data(), packet.size(), 0).has_target);
}

TEST(Agent, DamagedPacketsAreCountedAndChangeNothing) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({}));
  NeighbourState n;
  n.source = 1;
  HeardPacket r = Heard(s, n, 0);
  r.data[5] ^= 4;
  agent.Receive(r);
  EXPECT_EQ(agent.view().refused_packets(), 1U);
  EXPECT_TRUE(agent.neighbours().known().empty());
}

TEST(Agent, AttendsToItsOwnTargetOnly) {
  AgentModel s;
  s.target.count = 2;
  Agent agent(s, 1);
  EXPECT_EQ(agent.target(), 1);
  dynamics::Cue cue = CueAt({0.2, 0.0, 0.0});
  cue.target = 1;
  agent.Reset(0, cue);
  agent.Detect({0, 0, {-0.3, 0.0, 0.0}, 0.0});
  NeighbourState n;
  n.source = 2;
  n.has_target = true;
  n.target = 0;
  n.p_WT = {-0.3, 0.0, 0.0};
  n.target_std = 0.001;
  agent.Receive(Heard(s, n, 0));
  Look(&agent, Nav(0, {}));
  EXPECT_DOUBLE_EQ(agent.knowledge().r_BT_W.x, 0.2);
}

TEST(Agent, NonFiniteInputIsTheCallersBug) {
  const AgentModel s;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({}));
  float observation[128];
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    dynamics::NavState nav = Nav(0, {0.0, bad, 0.0});
    EXPECT_THROW(agent.Observe(nav, observation), std::invalid_argument);
    nav = Nav(0, {});
    nav.q_WB[3] = bad;
    EXPECT_THROW(agent.Observe(nav, observation), std::invalid_argument);
    nav = Nav(0, {});
    nav.w_WB_B.x = bad;
    EXPECT_THROW(agent.Observe(nav, observation), std::invalid_argument);
    EXPECT_THROW(agent.Detect({0, 0, {bad, 0.0, 0.0}, 0.0}), std::invalid_argument);
    EXPECT_NO_THROW(agent.Observe(Nav(0, {}), observation));
    const float action[] = {0.0F, static_cast<float>(bad), 0.0F};
    EXPECT_THROW(agent.Act(action), std::invalid_argument);
  }
  EXPECT_THROW(Agent(s, 4), std::invalid_argument);
}

TEST(Agent, PursuitSteersByTheAgentsOwnEstimates) {
  for (const dynamics::ActionInterface interface :
       {dynamics::ActionInterface::kVelocity3, dynamics::ActionInterface::kTau6}) {
    AgentModel s;
    s.control.interface = interface;
    Agent agent(s, 0);
    agent.Reset(0, CueAt({0.0, 0.0, 0.3}));
    Look(&agent, Nav(0, {}));
    float action[6];
    MakeController("pursuit")->Act(agent.view(), action);
    // Tau6 has gain 1, so this is the same fraction of the force.
    EXPECT_FLOAT_EQ(action[2], 0.75F);
    EXPECT_NEAR(action[0], 0.0F, 1e-7F);
    MakeController("idle")->Act(agent.view(), action);
    for (int k = 0; k < s.control.action_size(); ++k) EXPECT_EQ(action[k], 0.0F);
  }
}

}  // namespace
}  // namespace stg::agent

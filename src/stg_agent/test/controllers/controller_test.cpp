#include "stg_agent/controllers/controller.hpp"

#include <gtest/gtest.h>

#include "agent/agent_fixture.hpp"
#include "auv_common/error.hpp"
#include "stg_agent/controllers/pursuit.hpp"

namespace stg::agent {
namespace {

const std::vector<std::string> kBuiltIn = {
    "assign", "contain",        "encircle", "expanding_square",  "formation", "greedy_search",
    "idle",   "parallel_sweep", "pursuit",  "pursuit_separated", "search_map"};

/// An agent that has flown for a while among neighbours.
Agent Experienced(const AgentModel& s) {
  Agent agent(s, 0);
  agent.Reset(0, CueAt({0.2, 0.1, 0.0}));
  std::vector<float> observation;
  for (const Input& in : RandomEpisode(s, 0, 30, 7, {}, 0.03)) Drive(&agent, in, &observation);
  return agent;
}

/// The error message when this controller is made; empty for no error.
std::string ErrorOf(const std::string& text) {
  try {
    MakeController(text);
  } catch (const UserError& e) {
    return e.what();
  }
  return "";
}

TEST(Controllers, AreFoundByNameAndNothingElseIs) {
  for (const std::string& name : kBuiltIn) EXPECT_NE(MakeController(name), nullptr) << name;
  EXPECT_EQ(Controllers().Names(), kBuiltIn);
  EXPECT_TRUE(Controllers().Has(DefaultController()));
  for (const char* name : {"", "Pursuit", "pursuit ", "pursuit.onnx"}) {
    EXPECT_EQ(MakeController(name), nullptr) << name;
  }
}

TEST(Controllers, ANameMayCarryConstants) {
  const AgentModel s;
  const Agent agent = Experienced(s);
  PursuitSeparatedOptions options;
  options.gain_per_s = 0.25;
  options.feedforward = 1.2;
  const auto named = MakeController("pursuit_separated:gain=0.25,feedforward=1.2");
  float tuned[3], a[3], b[3];
  named->Act(agent.view(), a);
  ControllerOf<Pursuit>(Pursuit{options}).Act(agent.view(), b);
  MakeController("pursuit_separated")->Act(agent.view(), tuned);
  bool differs = false;
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(a[k], b[k]);
    differs = differs || a[k] != tuned[k];
  }
  EXPECT_TRUE(differs);
}

TEST(Controllers, AWrongConstantIsRefusedAndTheMessageQuotesIt) {
  for (const char* bad : {"pursuit:gain", "pursuit:gain=", "pursuit:gain=2x", "pursuit:gain=nan",
                          "pursuit:gain=-1", "pursuit:cap=1.1", "pursuit:speed=1", "idle:gain=1",
                          "pursuit:", "encircle:", "pursuit:gain=1,", "pursuit:,gain=1",
                          "pursuit:gain=1,,cap=1", "pursuit:gain=1,gain=1"}) {
    EXPECT_THROW(MakeController(bad), UserError) << bad;
  }
  EXPECT_EQ(ErrorOf("pursuit:gain=2x"), "'pursuit:gain=2x': gain: expected a number, found '2x'");
  EXPECT_EQ(ErrorOf("pursuit:cap=2"), "'pursuit:cap=2': cap: 2.0 is out of range [0, 1]");
  EXPECT_EQ(ErrorOf("idle:gain=1"), "'idle:gain=1': no such constant: gain; it has none");
  EXPECT_EQ(ErrorOf("pursuit:speed=1")
                .rfind("'pursuit:speed=1': no such constant: speed; it has gain", 0),
            0u);
  EXPECT_EQ(ErrorOf("pursuit:gian=2"),
            "'pursuit:gian=2': no such constant: gian; did you mean gain?");
  EXPECT_EQ(ErrorOf("pursuit:gain=1,gain=3"), "'pursuit:gain=1,gain=3': gain: given twice");
  EXPECT_EQ(ErrorOf("pursuit:gain=1,"),
            "'pursuit:gain=1,': a constant is missing after a colon or comma");
}

TEST(Controllers, PacksAndScalarsAgreeBitForBitInBothInterfaces) {
  for (const auto interface :
       {dynamics::ActionInterface::kVelocity3, dynamics::ActionInterface::kTau6}) {
    AgentModel s;
    s.control.interface = interface;
    const Agent agent = Experienced(s);
    const NearestSights one = agent.view().Nearest(3);
    const int count = one.size();
    ASSERT_GT(count, 0);
    Knowledge<Pack> knowledge{};
    NeighbourSight<Pack> packs[3];
    for (int lane = 0; lane < kLanes; ++lane) {
      SetLaneOf(&knowledge, lane, agent.knowledge());
      for (int j = 0; j < count; ++j) SetLaneOf(&packs[j], lane, one[j]);
    }
    for (const std::string& name : kBuiltIn) {
      const auto controller = MakeController(name);
      double a[dynamics::kMaxActionSize];
      Pack b[dynamics::kMaxActionSize];
      controller->Act({s, 0, agent.knowledge(), one.begin(), count}, a);
      controller->Act({s, 0, knowledge, packs, count}, b);
      for (int k = 0; k < s.control.action_size(); ++k) {
        EXPECT_EQ(a[k], Lane(b[k], kLanes - 1)) << name;
        EXPECT_LE(std::abs(a[k]), 1.0) << name;
      }
    }
  }
}

TEST(Controllers, AForceInterfaceIsGivenWhatTheVelocityControllerWouldDo) {
  AgentModel velocity, force;
  // The wanted velocity is executed unchanged.
  velocity.control.smoothing = velocity.control.max_delta = 0.0;
  force.control.interface = dynamics::ActionInterface::kTau6;
  Agent a(velocity, 0), b(force, 0);
  for (Agent* agent : {&a, &b}) {
    agent->Reset(0, CueAt({0.2, 0.1, -0.1}));
    std::vector<float> observation(static_cast<std::size_t>(agent->model().observation_size()));
    agent->Observe(Nav(0, {0.1, 0.0, 0.0}, {0.05, 0.02, 0.0}), observation.data());
  }
  float asked[dynamics::kMaxActionSize], action[dynamics::kMaxActionSize];
  MakeController("pursuit")->Act(a.view(), asked);
  MakeController("pursuit")->Act(b.view(), action);
  const AgentOutput out = a.Act(asked);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(action[k], out.fraction[k], 1e-6) << k;
}

TEST(Controllers, ALaneIsServedLikeAnAgentOfItsOwn) {
  const AgentModel s;
  Agent alone(s, 0);
  AgentLanes beside(std::make_shared<const AgentConstants>(s), 0);
  alone.Reset(0, CueAt({0.2, 0.1, 0.0}));
  for (int lane = 0; lane < kLanes; ++lane) beside.Reset(lane, 0, CueAt({0.2, 0.1, 0.0}));
  const auto controller = MakeController("pursuit_separated");
  std::vector<float> observation;
  for (const Input& in : RandomEpisode(s, 0, 60, 9, {}, 0.03)) {
    Drive(&alone, in, &observation);
    const int lane = kLanes - 1;
    for (const HeardPacket& r : in.receptions) beside.Receive(lane, r);
    for (const dynamics::Detection& d : in.detections) beside.Detect(lane, d);
    beside.Observe(InAllLanes(in.nav));
    float a[3], b[3];
    controller->Act(alone.view(), a);
    controller->Act(beside.view(lane), b);
    for (int k = 0; k < 3; ++k) ASSERT_EQ(a[k], b[k]);
  }
}

}  // namespace
}  // namespace stg::agent

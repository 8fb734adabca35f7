#include "stg_agent/agent/agent_lanes.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "agent_fixture.hpp"

namespace stg::agent {
namespace {

constexpr int kSteps = 150;

template <class T>
bool SameBits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

dynamics::Navigation<Pack> Beside(const std::vector<std::vector<Input>>& lanes, std::size_t step) {
  dynamics::Navigation<Pack> nav;
  for (int lane = 0; lane < kLanes; ++lane) {
    const dynamics::NavState& n = lanes[static_cast<std::size_t>(lane)][step].nav;
    nav.stamp = n.stamp;
    SetLane(&nav.p_WB, lane, n.p_WB);
    SetLane(&nav.v_WB_B, lane, n.v_WB_B);
    SetLane(&nav.w_WB_B, lane, n.w_WB_B);
    for (int k = 0; k < 4; ++k) SetLane(&nav.q_WB[k], lane, n.q_WB[k]);
  }
  return nav;
}

/// Flies AUV 1 through a different episode in every lane, alone and side by side, and compares
/// all that comes out, bit for bit. Neighbours fall silent from time to time.
void ExpectSame(const AgentConfig& s, unsigned seed) {
  std::vector<Agent> alone;
  std::vector<std::vector<Input>> lanes;
  AgentLanes beside(Agent(s, 0), 1);
  for (int lane = 0; lane < kLanes; ++lane) {
    alone.emplace_back(s, 1);
    lanes.push_back(RandomEpisode(s, 1, kSteps, seed + static_cast<unsigned>(lane)));
    const dynamics::Cue cue = CueAt({0.1 * lane, 0.0, 0.0});
    alone.back().Reset(3, cue);
    beside.Reset(lane, 3, cue);
  }
  int forgotten = 0;
  std::size_t known_before = 0;
  for (std::size_t step = 0; step < kSteps; ++step) {
    const bool silence = step % 40 >= 20;
    Pack wanted[6];
    for (int lane = 0; lane < kLanes; ++lane) {
      Input& in = lanes[static_cast<std::size_t>(lane)][step];
      if (silence) in.receptions.clear();
      for (const HeardPacket& r : in.receptions) beside.Receive(lane, r);
      for (const dynamics::Detection& d : in.detections) beside.Detect(lane, d);
      for (int k = 0; k < 6; ++k) SetLane(&wanted[k], lane, static_cast<double>(in.action[k]));
    }
    beside.Observe(Beside(lanes, step));
    std::vector<Pack> columns(static_cast<std::size_t>(s.observation_size()));
    BuildObservation(s, beside.knowledge(), [&](int k, const Pack& value) {
      columns[static_cast<std::size_t>(k)] = value;
    });
    beside.Act(wanted);
    for (int lane = 0; lane < kLanes; ++lane) {
      Agent& a = alone[static_cast<std::size_t>(lane)];
      std::vector<float> observation;
      const AgentOutput out = Drive(&a, lanes[static_cast<std::size_t>(lane)][step], &observation);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        ASSERT_TRUE(SameBits(observation[k], static_cast<float>(Lane(columns[k], lane))))
            << "step " << step << " lane " << lane << " number " << k;
      }
      for (int k = 0; k < 6; ++k) {
        ASSERT_TRUE(SameBits(out.fraction[k], Lane(beside.knowledge().tau[k], lane))) << step;
      }
      for (std::size_t k = 0; k < static_cast<std::size_t>(s.action_size()); ++k) {
        ASSERT_TRUE(SameBits(out.action[k], Lane(beside.action()[k], lane))) << step;
      }
      ASSERT_EQ(a.MakePacket(), beside.MakePacket(lane));
      const Agent& seen = beside.agent(lane);
      ASSERT_TRUE(SameBits(a.knowledge(), seen.knowledge()));
      ASSERT_EQ(a.neighbours().known(), seen.neighbours().known());
      for (const int id : a.neighbours().known()) {
        ASSERT_TRUE(SameBits(a.neighbours().at(id).r_BN_W, seen.neighbours().at(id).r_BN_W));
        ASSERT_EQ(a.neighbours().at(id).link_quality, seen.neighbours().at(id).link_quality);
      }
    }
    const std::size_t known = alone[0].neighbours().known().size();
    if (known < known_before) ++forgotten;
    known_before = known;
  }
  EXPECT_GT(forgotten, 0);
}

AgentConfig Forgetful(int agents) {
  AgentConfig s;
  s.agents = agents;
  s.track.neighbour_max_age_s = 0.7;
  return s;
}

TEST(AgentLanes, DoWhatSeparateAgentsDoBitForBit) {
  ExpectSame(Forgetful(4), 1);
  ExpectSame(Forgetful(9), 2);
  ExpectSame(Forgetful(2), 3);
}

TEST(AgentLanes, DoSoWithEveryKindOfLinkOrderAndAction) {
  AgentConfig range = Forgetful(5), index = Forgetful(5), tau = Forgetful(5), bow = Forgetful(5);
  range.channel.model = "range";
  index.observation.order = NeighbourOrder::kIndex;
  tau.control.interface = dynamics::ActionInterface::kTau6;
  bow.control.heading = dynamics::HeadingMode::kAlongVelocity;
  for (const AgentConfig& s : {range, index, tau, bow}) ExpectSame(s, 4);
}

TEST(AgentLanes, RefuseWhatIsNotFiniteInAnyLane) {
  const AgentConfig s;
  AgentLanes lanes(Agent(s, 0), 1);
  for (int lane = 0; lane < kLanes; ++lane) lanes.Reset(lane, 0, CueAt({}));
  dynamics::Navigation<Pack> nav;
  lanes.Observe(nav);
  Pack action[6] = {Pack(0.0), Pack(0.0), Pack(0.0), Pack(0.0), Pack(0.0), Pack(0.0)};
  SetLane(&action[2], kLanes - 1, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(lanes.Act(action), std::invalid_argument);
  SetLane(&nav.q_WB[3], kLanes - 1, std::numeric_limits<double>::infinity());
  EXPECT_THROW(lanes.Observe(nav), std::invalid_argument);
}

}  // namespace
}  // namespace stg::agent

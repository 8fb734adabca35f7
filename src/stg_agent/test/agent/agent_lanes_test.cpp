#include "stg_agent/agent/agent_lanes.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "agent/agent_fixture.hpp"

namespace stg::agent {
namespace {

constexpr int kSteps = 150;

template <class T>
bool SameBits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Flies AUV 1 in a different episode in every lane, in two ways: with one agent for each lane, and
/// with all lanes side by side.
class TwoWays {
 public:
  TwoWays(const AgentModel& s, unsigned seed)
      : scenario_(s), seed_(seed), beside_(std::make_shared<const AgentConstants>(s), 1) {
    for (int lane = 0; lane < kLanes; ++lane) {
      alone_.emplace_back(s, 1);
      episodes_.push_back({});
      steps_.push_back(0);
      Start(lane);
    }
  }

  /// Starts a new episode in one lane.
  void Start(int lane) {
    const dynamics::Cue cue = CueAt({0.1 * lane, 0.01 * started_, 0.0});
    episodes_[Index(lane)] = RandomEpisode(scenario_, 1, kSteps, seed_ + started_);
    steps_[Index(lane)] = 0;
    alone_[Index(lane)].Reset(started_, cue);
    beside_.Reset(lane, started_, cue);
    ++started_;
  }

  /// Gives all messages of this step to the agents of a lane. In times of silence it leaves out the
  /// packets of neighbours.
  void Tell(int lane) {
    const bool silence = steps_[Index(lane)] % 40 >= 20;
    for (const HeardPacket& r : in(lane).receptions) {
      if (silence) continue;
      beside_.Receive(lane, r);
      alone_[Index(lane)].Receive(r);
    }
    for (const dynamics::Detection& d : in(lane).detections) {
      beside_.Detect(lane, d);
      alone_[Index(lane)].Detect(d);
    }
  }

  void Observe() {
    for (int lane = 0; lane < kLanes; ++lane) {
      Tell(lane);
      ObserveAlone(lane);
    }
    beside_.Observe(Beside());
  }

  /// Observes in one lane. The navigation of the other lanes is nonsense at this time.
  void ObserveIn(int lane) {
    Tell(lane);
    ObserveAlone(lane);
    dynamics::Navigation<Pack> nav;
    Pack mine(0.0);
    SetLane(&mine, lane, 1.0);
    nav.p_WB = Broadcast({7.0, 8.0, 9.0});
    nav.v_WB_B = Broadcast({1.0, 1.0, 1.0});
    nav.stamp.fill(1'000'000 * kStep);
    SetNav(lane, &nav);
    beside_.Observe(nav, mine > Pack(0.5));
  }

  void ExpectSameKnowledge() {
    std::vector<Pack> columns;
    BuildObservation(scenario_, beside_.knowledge(),
                     [&](int, const Pack& value) { columns.push_back(value); });
    for (int lane = 0; lane < kLanes; ++lane) {
      const AgentView a = alone_[Index(lane)].view(), b = beside_.view(lane);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        ASSERT_TRUE(
            SameBits(observations_[Index(lane)][k], static_cast<float>(Lane(columns[k], lane))))
            << "lane " << lane << " number " << k;
      }
      ASSERT_TRUE(SameBits(a.knowledge(), b.knowledge())) << lane;
      ASSERT_EQ(a.neighbours().known(), b.neighbours().known()) << lane;
      for (const int id : a.neighbours().known()) {
        ASSERT_TRUE(SameBits(a.sight(id), b.sight(id))) << lane << " " << id;
      }
    }
  }

  /// Acts, and goes on to the next step.
  void Act() {
    Pack wanted[dynamics::kMaxActionSize];
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int k = 0; k < dynamics::kMaxActionSize; ++k) {
        SetLane(&wanted[k], lane, static_cast<double>(in(lane).action[k]));
      }
    }
    beside_.Act(wanted);
    for (int lane = 0; lane < kLanes; ++lane) {
      const AgentOutput out = alone_[Index(lane)].Act(in(lane).action);
      for (int k = 0; k < dynamics::kWrenchSize; ++k) {
        ASSERT_TRUE(SameBits(out.fraction[k], Lane(beside_.knowledge().tau[k], lane))) << lane;
      }
      for (std::size_t k = 0; k < static_cast<std::size_t>(scenario_.control.action_size()); ++k) {
        ASSERT_TRUE(SameBits(out.action[k], Lane(beside_.action()[k], lane))) << lane;
      }
      ASSERT_EQ(alone_[Index(lane)].MakePacket(), beside_.MakePacket(lane)) << lane;
      ++steps_[Index(lane)];
    }
    const std::size_t known = alone_[0].neighbours().known().size();
    if (known < known_before_) ++forgotten_;
    known_before_ = known;
  }

  int forgotten() const { return forgotten_; }

 private:
  static std::size_t Index(int lane) { return static_cast<std::size_t>(lane); }
  const Input& in(int lane) const { return episodes_[Index(lane)][steps_[Index(lane)]]; }

  void ObserveAlone(int lane) {
    observations_[Index(lane)].resize(static_cast<std::size_t>(scenario_.observation_size()));
    alone_[Index(lane)].Observe(in(lane).nav, observations_[Index(lane)].data());
  }

  void SetNav(int lane, dynamics::Navigation<Pack>* nav) const {
    const dynamics::NavState& n = in(lane).nav;
    nav->stamp[Index(lane)] = n.stamp;
    SetLane(&nav->p_WB, lane, n.p_WB);
    SetLane(&nav->v_WB_B, lane, n.v_WB_B);
    SetLane(&nav->w_WB_B, lane, n.w_WB_B);
    for (int k = 0; k < 4; ++k) SetLane(&nav->q_WB[k], lane, n.q_WB[k]);
  }

  dynamics::Navigation<Pack> Beside() const {
    dynamics::Navigation<Pack> nav;
    for (int lane = 0; lane < kLanes; ++lane) SetNav(lane, &nav);
    return nav;
  }

  AgentModel scenario_;
  unsigned seed_, started_ = 0;
  AgentLanes beside_;
  std::vector<Agent> alone_;                  // [lane]
  std::vector<std::vector<Input>> episodes_;  // [lane]
  std::vector<std::size_t> steps_;            // [lane]
  std::vector<float> observations_[kLanes];
  int forgotten_ = 0;
  std::size_t known_before_ = 0;
};

void ExpectSame(const AgentModel& s, unsigned seed) {
  TwoWays ways(s, seed);
  for (int step = 0; step < kSteps; ++step) {
    SCOPED_TRACE(step);
    ways.Observe();
    ASSERT_NO_FATAL_FAILURE(ways.ExpectSameKnowledge());
    ASSERT_NO_FATAL_FAILURE(ways.Act());
  }
  EXPECT_GT(ways.forgotten(), 0);
}

AgentModel Forgetful(int agents) {
  AgentModel s;
  s.run.agents = agents;
  s.track.neighbour_max_age_s = 0.7;
  return s;
}

TEST(AgentLanes, DoWhatSeparateAgentsDoBitForBit) {
  ExpectSame(Forgetful(4), 1);
  ExpectSame(Forgetful(9), 2);
  ExpectSame(Forgetful(2), 3);
}

TEST(AgentLanes, DoSoWithEveryKindOfLinkOrderAndAction) {
  AgentModel range = Forgetful(5), index = Forgetful(5), tau = Forgetful(5), bow = Forgetful(5);
  AgentModel physical = Forgetful(5);
  range.channel.model = "range";
  physical.channel.model = "physical";
  index.observation.order = NeighbourOrder::kIndex;
  tau.control.interface = dynamics::ActionInterface::kTau6;
  bow.control.heading = dynamics::HeadingMode::kAlongVelocity;
  for (const AgentModel& s : {range, physical, index, tau, bow}) ExpectSame(s, 4);
}

TEST(AgentLanes, OneLaneMayStartAnEpisodeWhileTheOthersGoOn) {
  for (const unsigned seed : {5U, 6U}) {
    AgentModel s = Forgetful(5);
    s.observation.error_window = seed == 5U ? 5 : 3;
    TwoWays ways(s, seed);
    for (int step = 0; step < kSteps; ++step) {
      SCOPED_TRACE(step);
      ways.Observe();
      // Lanes start anew after different times, as environments do whose episodes end at different
      // times.
      for (int lane = 0; lane < kLanes; ++lane) {
        if (step == 0 || step % (17 + 9 * lane) != 0) continue;
        ways.Start(lane);
        ways.ObserveIn(lane);
      }
      ASSERT_NO_FATAL_FAILURE(ways.ExpectSameKnowledge());
      ASSERT_NO_FATAL_FAILURE(ways.Act());
    }
    EXPECT_GT(ways.forgotten(), 0);
  }
}

TEST(AgentLanes, RefuseWhatIsNotFiniteInAnyLane) {
  const AgentModel s;
  AgentLanes lanes(std::make_shared<const AgentConstants>(s), 1);
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

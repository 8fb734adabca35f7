#include "stg_agent/graph/neighbourhood.hpp"

#include <gtest/gtest.h>

#include "acoustic_channel/models/extended.hpp"
#include "acoustic_channel/models/range.hpp"
#include "agent/agent_fixture.hpp"

namespace stg::agent {
namespace {

/// Predicts the neighbours of one lane to a time. The AUV is at p_WB.
void Predict(Neighbourhood<double>* neighbours, TimeNs now, const Vec3<double>& p_WB,
             const AgentModel& s = AgentModel()) {
  neighbours->Age(static_cast<double>(now));
  neighbours->Predict(p_WB, *acoustics::MakeLinkEstimator(s.channel, s.run.agents));
}

TEST(Neighbourhood, DeadReckonsFromTheGenerationTime) {
  Neighbourhood<double> neighbours{AgentModel(), 0};
  neighbours.Update(0, Report(2, kSecond, {0.1, 0.2, 0.3}, {0.1, -0.1, 0.0}));
  Predict(&neighbours, 3 * kSecond, {0.3, 0.0, 0.0});
  const NeighbourSight<double>& n = neighbours.sights()[2];
  EXPECT_EQ(n.known, 1.0);
  EXPECT_DOUBLE_EQ(n.age_s, 2.0);
  EXPECT_NEAR(n.p_WN.x, 0.3, 1e-15);
  EXPECT_NEAR(n.p_WN.y, 0.0, 1e-15);
  EXPECT_NEAR(n.r_BN_W.z, 0.3, 1e-15);
  EXPECT_NEAR(n.distance_m, 0.3, 1e-15);
}

TEST(Neighbourhood, DeadReckoningStopsAtTheWalls) {
  Neighbourhood<double> neighbours{AgentModel(), 0};
  neighbours.Update(0, Report(1, 0, {0.9, 0.0, 0.0}, {1.5, 0.0, 0.0}));
  Predict(&neighbours, 5 * kSecond, {});
  EXPECT_DOUBLE_EQ(neighbours.sights()[1].p_WN.x, 1.0);
}

TEST(Neighbourhood, TellsWhenAReportIsTooOldUntilItIsForgotten) {
  Neighbourhood<Pack> neighbours{AgentModel(), 0};  // it forgets after 10 s
  const int last = kLanes - 1;
  neighbours.Update(last, Report(1, 0, {}));
  const auto old = [&](TimeNs now) {
    return Select(neighbours.Age(Pack(static_cast<double>(now))), Pack(1.0), Pack(0.0));
  };
  EXPECT_EQ(Lane(old(10 * kSecond), last), 0.0);
  EXPECT_EQ(Lane(old(10 * kSecond + 1), last), 1.0);
  if (kLanes > 1) {
    EXPECT_EQ(Lane(old(10 * kSecond + 1), 0), 0.0) << "no neighbour was heard there";
  }
  neighbours.Forget(last, 10 * kSecond + 1);
  EXPECT_EQ(Lane(old(10 * kSecond + 1), last), 0.0);
}

TEST(Neighbourhood, QualityIsEquation5Or6OfEveryLinkForAnySwarmSize) {
  for (const char* model : {"range", "extended"}) {
    for (const int agents : {2, 4, 7, 23}) {
      AgentModel s;
      s.run.agents = agents;
      s.channel.model = model;
      Neighbourhood<double> neighbours(s, 1);
      for (int i = agents - 1; i >= 0; --i) {
        if (i != 1) neighbours.Update(0, Report(i, i * kSecond / 10, {0.03 * i, 0.1, 0.0}));
      }
      Predict(&neighbours, 3 * kSecond, {}, s);
      for (int i = 0; i < agents; ++i) {
        if (i == 1) continue;
        const NeighbourSight<double>& n = neighbours.sights()[static_cast<std::size_t>(i)];
        const double q =
            s.channel.model == "range"
                ? acoustics::RangeQuality(n.distance_m, s.channel.range_m)
                : acoustics::ExtendedQuality(n.distance_m, n.age_s, s.channel.extended);
        EXPECT_EQ(n.link_quality, q) << model;
        EXPECT_GT(q, 0.0 - 1e-300);
      }
    }
  }
}

TEST(AgentView, NearestAreSortedAndTiesGoToTheLowerIndex) {
  AgentModel s;
  s.run.agents = 8;
  Agent agent(s, 0);
  agent.Reset(0, CueAt({}));
  const double x[] = {0.0, 0.5, 0.2, 0.9, 0.2, 0.1, 0.7, 0.4};
  for (int i = 1; i < 8; ++i) {
    NeighbourState n = Report(i, 0, {x[i], 0.0, 0.0});
    n.tracking_error = 0.01 * i;  // this number shows which neighbour it is
    agent.Receive(Heard(s, n, 0));
  }
  std::vector<float> observation(static_cast<std::size_t>(s.observation_size()));
  agent.Observe(Nav(0, {}), observation.data());
  const AgentView view = agent.view();
  const auto index = [](const NeighbourSight<double>& n) {
    return static_cast<int>(std::lround(100.0 * n.tracking_error));
  };
  NearestSights nearest = view.Nearest(3);
  ASSERT_EQ(nearest.size(), 3);
  EXPECT_EQ(index(nearest[0]), 5);
  EXPECT_EQ(index(nearest[1]), 2);
  EXPECT_EQ(index(nearest[2]), 4);
  nearest = view.Nearest();
  ASSERT_EQ(nearest.size(), 7);
  for (int k = 1; k < 7; ++k) EXPECT_LE(nearest[k - 1].distance_m, nearest[k].distance_m);
}

}  // namespace
}  // namespace stg::agent

#include "stg_agent/inbox/neighbour_table.hpp"

#include <gtest/gtest.h>

#include "acoustic_channel/link/link_quality.hpp"

namespace stg::agent {
namespace {

constexpr TimeNs kSecond = 1'000'000'000;

NeighbourState State(int source, TimeNs generation, const Vec3<double>& p,
                     const Vec3<double>& v = {}) {
  NeighbourState s;
  s.source = source;
  s.generation = generation;
  s.p_W = p;
  s.v_W = v;
  return s;
}

TEST(NeighbourTable, DeadReckonsFromTheGenerationTime) {
  NeighbourTable table(AgentConfig(), 0);
  ASSERT_TRUE(table.Update(State(2, kSecond, {0.1, 0.2, 0.3}, {0.1, -0.1, 0.0})));
  table.Predict(3 * kSecond, {0.3, 0.0, 0.0});
  const Neighbour& n = table.at(2);
  EXPECT_DOUBLE_EQ(n.age_s, 2.0);
  EXPECT_NEAR(n.p_WN.x, 0.3, 1e-15);
  EXPECT_NEAR(n.p_WN.y, 0.0, 1e-15);
  EXPECT_NEAR(n.r_BN_W.z, 0.3, 1e-15);
  EXPECT_NEAR(n.distance_m, 0.3, 1e-15);
}

TEST(NeighbourTable, DeadReckoningStopsAtTheWalls) {
  NeighbourTable table(AgentConfig(), 0);
  table.Update(State(1, 0, {0.9, 0.0, 0.0}, {1.5, 0.0, 0.0}));
  table.Predict(5 * kSecond, {});
  EXPECT_DOUBLE_EQ(table.at(1).p_WN.x, 1.0);
}

TEST(NeighbourTable, KeepsTheNewestStateWhateverTheOrder) {
  NeighbourTable table(AgentConfig(), 0);
  EXPECT_TRUE(table.Update(State(1, 2 * kSecond, {0.2, 0.0, 0.0})));
  EXPECT_FALSE(table.Update(State(1, kSecond, {0.1, 0.0, 0.0})));
  EXPECT_FALSE(table.Update(State(1, 2 * kSecond, {0.5, 0.0, 0.0})));
  table.Predict(2 * kSecond, {});
  EXPECT_DOUBLE_EQ(table.at(1).p_WN.x, 0.2);
}

TEST(NeighbourTable, IgnoresOneselfAndStrangers) {
  NeighbourTable table(AgentConfig(), 3);
  EXPECT_FALSE(table.Update(State(3, 0, {})));
  EXPECT_FALSE(table.Update(State(-1, 0, {})));
  EXPECT_FALSE(table.Update(State(4, 0, {})));
  EXPECT_TRUE(table.known().empty());
}

TEST(NeighbourTable, ForgetsTheSilentAndTakesThemBack) {
  AgentConfig s;
  NeighbourTable table(s, 0);
  table.Update(State(1, 0, {}));
  table.Update(State(2, 5 * kSecond, {}));
  table.Predict(10 * kSecond, {});
  EXPECT_EQ(table.known(), (std::vector<int>{1, 2}));
  table.Predict(10 * kSecond + 1, {});
  EXPECT_EQ(table.known(), (std::vector<int>{2}));
  EXPECT_FALSE(table.at(1).known);
  EXPECT_TRUE(table.Update(State(1, 11 * kSecond, {})));
  table.Predict(11 * kSecond, {});
  EXPECT_EQ(table.known(), (std::vector<int>{1, 2}));
}

TEST(NeighbourTable, QualityIsEquation5Or6OfEveryLinkForAnySwarmSize) {
  for (const char* model : {"range", "extended"}) {
    for (const int agents : {2, 4, 7, 23}) {
      AgentConfig s;
      s.agents = agents;
      s.channel.model = model;
      NeighbourTable table(s, 1);
      for (int i = agents - 1; i >= 0; --i) {
        table.Update(State(i, i * kSecond / 10, {0.03 * i, 0.1, 0.0}));
      }
      table.Predict(3 * kSecond, {});
      ASSERT_EQ(static_cast<int>(table.known().size()), agents - 1);
      for (const int i : table.known()) {
        const Neighbour& n = table.at(i);
        const double q = s.channel.model == "range"
                             ? acoustics::RangeQuality(n.distance_m, s.channel.range_m)
                             : acoustics::ExtendedQuality(n.distance_m, n.age_s, s.channel);
        EXPECT_EQ(n.link_quality, q);
        EXPECT_GT(q, 0.0 - 1e-300);
      }
    }
  }
}

TEST(NeighbourTable, NearestAreSortedAndTiesGoToTheLowerIndex) {
  AgentConfig s;
  s.agents = 8;
  NeighbourTable table(s, 0);
  const double x[] = {0.0, 0.5, 0.2, 0.9, 0.2, 0.1, 0.7, 0.4};
  for (int i = 1; i < 8; ++i) table.Update(State(i, 0, {x[i], 0.0, 0.0}));
  table.Predict(0, {});
  int ids[10];
  ASSERT_EQ(table.Nearest(3, ids), 3);
  EXPECT_EQ(ids[0], 5);
  EXPECT_EQ(ids[1], 2);
  EXPECT_EQ(ids[2], 4);
  ASSERT_EQ(table.Nearest(10, ids), 7);
  for (int k = 1; k < 7; ++k) EXPECT_LE(x[ids[k - 1]], x[ids[k]]);
}

}  // namespace
}  // namespace stg::agent

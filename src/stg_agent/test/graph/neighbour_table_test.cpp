#include "stg_agent/graph/neighbour_table.hpp"

#include <gtest/gtest.h>

#include "agent/agent_fixture.hpp"

namespace stg::agent {
namespace {

TEST(NeighbourTable, KeepsTheNewestStateWhateverTheOrder) {
  NeighbourTable table(AgentModel(), 0);
  EXPECT_TRUE(table.Update(Report(1, 2 * kSecond, {0.2, 0.0, 0.0})));
  EXPECT_FALSE(table.Update(Report(1, kSecond, {0.1, 0.0, 0.0})));
  EXPECT_FALSE(table.Update(Report(1, 2 * kSecond, {0.5, 0.0, 0.0})));
  EXPECT_DOUBLE_EQ(table.state(1).p_W.x, 0.2);
}

TEST(NeighbourTable, IgnoresOneselfAndStrangers) {
  NeighbourTable table(AgentModel(), 3);
  EXPECT_FALSE(table.Update(Report(3, 0, {})));
  EXPECT_FALSE(table.Update(Report(-1, 0, {})));
  EXPECT_FALSE(table.Update(Report(4, 0, {})));
  EXPECT_TRUE(table.known().empty());
}

TEST(NeighbourTable, ForgetsTheSilentAndTakesThemBack) {
  AgentModel s;
  NeighbourTable table(s, 0);
  table.Update(Report(1, 0, {}));
  table.Update(Report(2, 5 * kSecond, {}));
  table.Forget(10 * kSecond);
  EXPECT_EQ(table.known(), (std::vector<int>{1, 2}));
  table.Forget(10 * kSecond + 1);
  EXPECT_EQ(table.known(), (std::vector<int>{2}));
  EXPECT_FALSE(table.knows(1));
  EXPECT_TRUE(table.Update(Report(1, 11 * kSecond, {})));
  table.Forget(11 * kSecond);
  EXPECT_EQ(table.known(), (std::vector<int>{1, 2}));
}

TEST(NeighbourTable, ATargetEstimateIsReadOnce) {
  NeighbourTable table(AgentModel(), 0);
  NeighbourState with = Report(1, 0, {});
  with.has_target = true;
  table.Update(Report(2, 0, {}));
  EXPECT_FALSE(table.unread());
  table.Update(with);
  EXPECT_TRUE(table.unread() && table.unread(1) && !table.unread(2));
  table.MarkRead();
  EXPECT_FALSE(table.unread() || table.unread(1));
}

}  // namespace
}  // namespace stg::agent

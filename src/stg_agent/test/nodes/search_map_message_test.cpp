#include <gtest/gtest.h>

#include <cmath>

#include "agent_messages.hpp"

namespace stg::nodes {
namespace {

constexpr double kEast_m = 700.0, kNorth_m = -300.0, kUp_m = -40.0, kStd_m = 400.0;
constexpr double kCell_m = 100.0, kHalf_m = 1200.0, kRange_m = 300.0, kDetects = 0.8;

agent::AgentModel Searchers() {
  agent::AgentModel s;
  s.run.agents = 2;
  s.workspace.half_extent_m = kHalf_m;
  s.sensing.range_m = kRange_m;
  s.sensing.detection_probability = kDetects;
  s.sensing.period_s = 5.0;
  s.track.search_cell_m = kCell_m;
  return s;
}

nav_msgs::OccupancyGrid GridOf(const agent::SearchMemory& search) {
  nav_msgs::OccupancyGrid grid;
  EXPECT_TRUE(SetSearchMap(search, ros::Time(7, 0), &grid));
  return grid;
}

/// Compares each cell of a grid with 100 p / max p. Where the cells are follows from the message
/// alone, and p from the datum and a look in vain from a place.
void ExpectValues(const nav_msgs::OccupancyGrid& grid, const Vec3<double>& looked_from) {
  const double side = static_cast<double>(grid.info.resolution);
  const auto middle = [side](double corner, std::uint32_t k) { return corner + (k + 0.5) * side; };
  std::vector<double> p;
  double largest = 0.0;
  for (std::uint32_t r = 0; r < grid.info.height; ++r) {
    for (std::uint32_t c = 0; c < grid.info.width; ++c) {
      const double x = middle(grid.info.origin.position.x, c);
      const double y = middle(grid.info.origin.position.y, r);
      const double off = std::hypot(x - kEast_m, y - kNorth_m) / kStd_m;
      const bool seen = std::hypot(x - looked_from.x, y - looked_from.y) <= kRange_m;
      const bool inside = std::abs(x) <= kHalf_m && std::abs(y) <= kHalf_m;
      p.push_back(inside ? std::exp(-0.5 * off * off) * (seen ? 1.0 - kDetects : 1.0) : -1.0);
      largest = std::max(largest, p.back());
    }
  }
  ASSERT_EQ(grid.data.size(), p.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p[k] < 0.0) {
      EXPECT_EQ(grid.data[k], -1) << k;
    } else {
      EXPECT_NEAR(grid.data[k], 100.0 * p[k] / largest, 0.5 + 1e-6) << k;
    }
  }
}

TEST(SearchMapMessage, CellsHaveTheirSharesOfTheLargestOne) {
  agent::SearchMemory search(Searchers());
  search.Start({0, {kEast_m, kNorth_m, kUp_m}, kStd_m});
  const Vec3<double> nowhere{1e6, 1e6, 0.0};
  ExpectValues(GridOf(search), nowhere);
  // North-east of the datum, so that neither axes nor directions can be exchanged.
  const Vec3<double> p_WB{1000.0, -100.0, -30.0};
  search.Update(0, p_WB, agent::NeighbourTable(Searchers(), 0));
  ExpectValues(GridOf(search), p_WB);
}

TEST(SearchMapMessage, SaysWhereItLies) {
  agent::SearchMemory search(Searchers());
  search.Start({0, {kEast_m, kNorth_m, kUp_m}, kStd_m});
  const nav_msgs::OccupancyGrid grid = GridOf(search);
  EXPECT_EQ(grid.header.frame_id, "world");
  EXPECT_EQ(grid.header.stamp, ros::Time(7, 0));
  EXPECT_EQ(grid.info.width, 32U);
  EXPECT_EQ(grid.info.height, 32U);
  EXPECT_EQ(grid.info.resolution, 100.0F);
  // The map of 3.2 km is wider than the workspace of 2.4 km, so they have one middle.
  EXPECT_DOUBLE_EQ(grid.info.origin.position.x, -1600.0);
  EXPECT_DOUBLE_EQ(grid.info.origin.position.y, -1600.0);
  EXPECT_DOUBLE_EQ(grid.info.origin.position.z, 0.0);
  EXPECT_EQ(grid.info.origin.orientation.w, 1.0);
}

TEST(SearchMapMessage, WithoutADatumThereIsNone) {
  nav_msgs::OccupancyGrid grid;
  EXPECT_FALSE(SetSearchMap(agent::SearchMemory(Searchers()), ros::Time(7, 0), &grid));
}

TEST(SearchMapMessage, ComesEveryFiveSeconds) {
  const auto count = [](TimeNs step, int steps) {
    int shown = 0;
    for (int k = 0; k < steps; ++k) shown += ShowsSearchMap(k * step, step) ? 1 : 0;
    return shown;
  };
  constexpr TimeNs kSecond = 1'000'000'000;
  EXPECT_TRUE(ShowsSearchMap(0, kSecond));
  EXPECT_FALSE(ShowsSearchMap(4 * kSecond, kSecond));
  EXPECT_TRUE(ShowsSearchMap(5 * kSecond, kSecond));
  EXPECT_EQ(count(kSecond, 100), 20);
  EXPECT_EQ(count(kSecond / 10, 1000), 20);
  EXPECT_EQ(count(3 * kSecond, 100), 60);
  EXPECT_EQ(count(8 * kSecond, 100), 100) << "longer steps: each of them";
}

}  // namespace
}  // namespace stg::nodes

#include "stg_agent/search/search_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "stg_agent/search/search_memory.hpp"

namespace stg::agent {
namespace {

TimeNs Ns(double time_s) { return static_cast<TimeNs>(time_s * 1e9); }

AgentModel Searchers() {
  AgentModel s;
  s.run.agents = 3;
  s.workspace.half_extent_m = 4000.0;
  s.sensing.range_m = 400.0;
  s.sensing.detection_probability = 0.8;
  s.sensing.period_s = 5.0;
  s.track.search_cell_m = 100.0;
  s.track.velocity_std_mps = 0.5;
  s.track.velocity_memory_s = 80.0;
  return s;
}

SearchMap At(const AgentModel& s, double std_m) {
  SearchMap map(s);
  map.Start({0, {1000.0, -500.0, -40.0}, std_m});
  return map;
}

struct Moments {
  double total = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0;
};
Moments MomentsOf(const SearchMap& map) {
  Moments m;
  const auto each = [&map](const auto& take) {
    for (int r = 0; r < SearchMap::kSide; ++r) {
      for (int c = 0; c < SearchMap::kSide; ++c) take(map.mass(r, c), map.x(c), map.y(r));
    }
  };
  each([&m](double p, double x, double y) {
    m.total += p;
    m.x += p * x;
    m.y += p * y;
  });
  each([&m](double p, double x, double y) {
    m.xx += p * (x - m.x) * (x - m.x);
    m.yy += p * (y - m.y) * (y - m.y);
  });
  return m;
}

TEST(SearchMap, BeginsAsTheDatumSays) {
  const Moments m = MomentsOf(At(Searchers(), 300.0));
  EXPECT_NEAR(m.total, 1.0, 1e-12);
  EXPECT_NEAR(m.x, 1000.0, 1e-6);
  EXPECT_NEAR(m.y, -500.0, 1e-6);
  EXPECT_NEAR(std::sqrt(m.xx), 300.0, 1.0);
  EXPECT_NEAR(std::sqrt(m.yy), 300.0, 1.0);
}

TEST(SearchMap, ALookInVainIsBayesRule) {
  const AgentModel s = Searchers();
  const SearchMap before = At(s, 500.0);
  SearchMap after = before;
  const Vec3<double> p_WO{1030.0, -450.0, -30.0};
  after.LookInVain(p_WO);
  double evidence = 0.0;
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) {
      const double range = std::hypot(before.x(c) - p_WO.x, before.y(r) - p_WO.y);
      evidence += before.mass(r, c) * (range > 400.0 ? 1.0 : 0.2);
    }
  }
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) {
      const double range = std::hypot(before.x(c) - p_WO.x, before.y(r) - p_WO.y);
      const double expected = before.mass(r, c) * (range > 400.0 ? 1.0 : 0.2) / evidence;
      ASSERT_NEAR(after.mass(r, c), expected, 1e-12);
    }
  }
}

TEST(SearchMap, SpreadsAsAWalkDoes) {
  const AgentModel s = Searchers();
  SearchMap map = At(s, 200.0);
  const double before = MomentsOf(map).xx;
  for (int k = 1; k <= 20; ++k) map.Advance(Ns(25.0 * k));
  // The variance grows by 2 s^2 m t = 2 0.25 80 500.
  EXPECT_NEAR(MomentsOf(map).xx - before, 20000.0, 200.0);
  EXPECT_NEAR(MomentsOf(map).total, 1.0, 1e-12);
}

TEST(SearchMap, ARangeLeavesARing) {
  SearchMap map = At(Searchers(), 800.0);
  dynamics::Detection d;
  d.kind = dynamics::MeasurementKind::kRange;
  d.p_WO = {1000.0, -500.0, -30.0};
  d.range_m = 300.0;
  d.range_std_m = 4.0;
  map.Find(d);
  double near_ring = 0.0;
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) {
      if (std::abs(std::hypot(map.x(c) - 1000.0, map.y(r) + 500.0) - 300.0) < 130.0) {
        near_ring += map.mass(r, c);
      }
    }
  }
  // The rest of the mass is there because the detection may be a false one.
  EXPECT_GT(near_ring, 0.8);
}

TEST(SearchMap, NothingLiesOutsideOfTheWorkspace) {
  AgentModel s = Searchers();
  s.workspace.half_extent_m = 1200.0;
  const SearchMap map = At(s, 800.0);
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) {
      if (map.x(c) > 1200.0) {
        EXPECT_EQ(map.mass(r, c), 0.0);
      }
    }
  }
  EXPECT_NEAR(MomentsOf(map).total, 1.0, 1e-12);
}

TEST(SearchMemory, APacketWithoutAMeasurementIsALookInVain) {
  const AgentModel s = Searchers();
  SearchMemory sent(s), looked(s);
  const dynamics::Cue cue{0, {0.0, 0.0, -40.0}, 500.0};
  sent.Start(cue);
  looked.Start(cue);
  NeighbourTable nobody(s, 0), table(s, 0);
  NeighbourState state;
  state.source = 2;
  state.generation = Ns(3.0);
  state.p_W = {200.0, 100.0, -30.0};
  table.Update(state);
  const Vec3<double> far{3900.0, 3900.0, -20.0};
  sent.Update(Ns(5.0), far, table);
  looked.Update(Ns(5.0), state.p_W, nobody);
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) {
      ASSERT_NEAR(sent.map().mass(r, c), looked.map().mass(r, c), 1e-12);
    }
  }
  // The same packet a second time changes nothing.
  const double before = sent.map().mass(15, 15);
  sent.Update(Ns(10.0), far, table);
  EXPECT_NEAR(sent.map().mass(15, 15), before, 1e-12);
}

}  // namespace
}  // namespace stg::agent

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stg_agent/controllers/search_laws.hpp"

namespace stg::agent {
namespace {

double DistanceToLeg(const Level<double>& p, const Level<double>& a, const Level<double>& b) {
  const Level<double> ab = b - a, ap = p - a;
  const double share = std::clamp(Dot(ap, ab) / std::max(Dot(ab, ab), 1e-9), 0.0, 1.0);
  return Norm(ap - ab * share);
}

TEST(ExpandingSquare, HasLegsOfOneOneTwoTwoSpacings) {
  const Level<double> datum{100.0, 50.0};
  const double expected[6][2] = {{0, 0}, {1, 0}, {1, 1}, {-1, 1}, {-1, -1}, {2, -1}};
  for (int leg = 0; leg < 6; ++leg) {
    const Level<double> p = SquareWaypoint(datum, 200.0, 0, 4, leg);
    EXPECT_NEAR(p.x, 100.0 + 200.0 * expected[leg][0], 1e-9) << leg;
    EXPECT_NEAR(p.y, 50.0 + 200.0 * expected[leg][1], 1e-9) << leg;
  }
  // The square of the second of four AUVs is turned by a quarter turn.
  EXPECT_NEAR(SquareWaypoint(datum, 200.0, 1, 4, 1).y, 250.0, 1e-9);
}

TEST(ParallelSweep, CoversTheBoxWithinHalfASpacing) {
  const Level<double> datum{-30.0, 70.0};
  const double half = 1250.0, spacing = 600.0;
  double worst = 0.0;
  for (double x = -half; x <= half; x += 50.0) {
    for (double y = -half; y <= half; y += 50.0) {
      double nearest = 1e9;
      for (int id = 0; id < 3; ++id) {
        for (int leg = 0; leg < 4; ++leg) {
          nearest = std::min(
              nearest, DistanceToLeg(datum + Level<double>{x, y},
                                     SweepWaypoint(datum, half, spacing, id, 3, leg, id == 1),
                                     SweepWaypoint(datum, half, spacing, id, 3, leg + 1, id == 1)));
        }
      }
      worst = std::max(worst, nearest);
    }
  }
  EXPECT_LE(worst, 0.5 * spacing);
  EXPECT_GT(worst, 0.3 * spacing);
}

TEST(CourseToMass, PointsAtThePartOfARingThatNobodyHasLookedAt) {
  AgentModel m;
  m.workspace.half_extent_m = 4000.0;
  m.sensing.range_m = 400.0;
  m.sensing.detection_probability = 0.9;
  m.track.search_cell_m = 100.0;
  SearchMap map(m);
  map.Start({0, {0.0, 0.0, -40.0}, 600.0});
  // The AUV has come from the west without a detection. Then it has one range of 350 m.
  for (double x = -800.0; x < -99.0; x += 50.0) map.LookInVain({x, 0.0, -40.0});
  dynamics::Detection d;
  d.kind = dynamics::MeasurementKind::kRange;
  d.p_WO = {0.0, 0.0, -40.0};
  d.range_m = 350.0;
  d.range_std_m = 5.0;
  map.Find(d);
  const Vec3<double> p_WB{0.0, 0.0, -40.0};
  for (const double old : {0.0, 2.0, -3.0}) {
    EXPECT_NEAR(CourseToMass(map, p_WB, 500.0, old, 1.0), 0.0, 0.5 * kPi / 8.0) << old;
  }
  // The law keeps a course that is nearly as good.
  EXPECT_EQ(CourseToMass(map, p_WB, 500.0, 0.3, 1.2), 0.3);
}

}  // namespace
}  // namespace stg::agent

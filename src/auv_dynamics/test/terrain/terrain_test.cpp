#include "auv_dynamics/terrain/terrain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "auv_common/error.hpp"

namespace stg::dynamics {
namespace {

constexpr double kDegreeNorth_m = 110'574.0;  // at the equator

TEST(Datum, GoesThereAndBack) {
  const Datum datum(21.85, 122.25);
  EXPECT_LT(Norm(datum.ToWorld(21.85, 122.25, 0.0)), 1e-9);
  // North is y, east is x; a degree of latitude is 110.7 km here.
  const Vec3<double> north = datum.ToWorld(21.86, 122.25, 0.0);
  EXPECT_NEAR(north.y, 1107.2, 0.5);
  EXPECT_NEAR(north.x, 0.0, 1e-6);
  EXPECT_GT(datum.ToWorld(21.85, 122.26, 0.0).x, 1030.0);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(-5000.0, 5000.0), depth(-200.0, 0.0);
  for (int k = 0; k < 100; ++k) {
    const Vec3<double> p{place(random), place(random), depth(random)};
    const Datum::Geodetic g = datum.ToGeodetic(p);
    EXPECT_LT(Norm(datum.ToWorld(g.latitude_deg, g.longitude_deg, g.height_m) - p), 1e-6);
  }
  EXPECT_THROW(Datum(91.0, 0.0), UserError);
  EXPECT_THROW(Datum(0.0, std::nan("")), UserError);
}

/// A plane that falls by 1 m per 100 m to the north, 100 m deep at the equator.
Bathymetry Slope() {
  std::vector<double> lats, lons;
  std::vector<float> elevations;
  for (int k = -10; k <= 10; ++k) lats.push_back(0.01 * k);
  for (int k = -10; k <= 10; ++k) lons.push_back(30.0 + 0.01 * k);
  for (const double lat : lats) {
    for (size_t c = 0; c < lons.size(); ++c) {
      elevations.push_back(static_cast<float>(-100.0 - 0.01 * lat * kDegreeNorth_m));
    }
  }
  return {lats, lons, elevations};
}

TEST(Terrain, IsTheGridInTheWorldsFrame) {
  const Terrain terrain(Slope(), Datum(0.0, 30.0), 5000.0);
  for (const double y : {-4000.0, -100.0, 0.0, 777.0, 4999.0}) {
    for (const double x : {-3000.0, 0.0, 5000.0}) {
      EXPECT_NEAR(terrain.Height(x, y), -100.0 - 0.01 * y, 0.05) << x << " " << y;
    }
  }
  EXPECT_NEAR(terrain.Altitude({0.0, 1000.0, -60.0}), 50.0, 0.05);
  EXPECT_LE(terrain.spacing_m(), 600.0);
  EXPECT_NEAR(terrain.highest(), -50.0, 0.1);
  // Beyond its square, the terrain goes on as at its edge.
  EXPECT_EQ(terrain.Height(0.0, 9000.0), terrain.Height(0.0, 5000.0));
}

TEST(Terrain, RefusesADatumThatTheGridDoesNotCover) {
  EXPECT_THROW(Terrain(Slope(), Datum(0.0, 40.0), 1000.0), UserError);
  EXPECT_THROW(Terrain(Slope(), Datum(0.0, 30.0), 20000.0), UserError);
  EXPECT_THROW(Terrain(Slope(), Datum(0.0, 30.0), 0.0), UserError);
  EXPECT_THROW(Terrain(-5.0), UserError);
}

TEST(Obstacle, DistancesAndSegmentsOfSphereAndCylinder) {
  const Obstacle sphere{Obstacle::Kind::kSphere, {10.0, 0.0, -50.0}, 5.0, 0.0};
  EXPECT_NEAR(sphere.Distance({10.0, 0.0, -40.0}), 5.0, 1e-12);
  EXPECT_NEAR(sphere.Distance({10.0, 0.0, -50.0}), -5.0, 1e-12);
  EXPECT_TRUE(sphere.Blocks({0.0, 0.0, -50.0}, {20.0, 0.0, -50.0}));
  EXPECT_TRUE(sphere.Blocks({0.0, 4.9, -50.0}, {20.0, 4.9, -50.0}));
  EXPECT_FALSE(sphere.Blocks({0.0, 5.1, -50.0}, {20.0, 5.1, -50.0}));
  // The line ends before the sphere.
  EXPECT_FALSE(sphere.Blocks({0.0, 0.0, -50.0}, {4.9, 0.0, -50.0}));
  const Obstacle pile{Obstacle::Kind::kCylinder, {0.0, 0.0, -120.0}, 3.0, 80.0};
  EXPECT_NEAR(pile.Distance({7.0, 0.0, -100.0}), 4.0, 1e-12);
  EXPECT_NEAR(pile.Distance({0.0, 0.0, -30.0}), 10.0, 1e-12);
  EXPECT_NEAR(pile.Distance({6.0, 0.0, -36.0}), 5.0, 1e-12);
  EXPECT_LT(pile.Distance({1.0, 0.0, -100.0}), 0.0);
  EXPECT_TRUE(pile.Blocks({-10.0, 0.0, -100.0}, {10.0, 0.0, -100.0}));
  // The line passes over its top.
  EXPECT_FALSE(pile.Blocks({-10.0, 0.0, -39.0}, {10.0, 0.0, -39.0}));
  EXPECT_FALSE(pile.Blocks({-10.0, 3.1, -100.0}, {10.0, 3.1, -100.0}));
  // The first line comes down through the top. The second one has passed before it is low enough.
  EXPECT_TRUE(pile.Blocks({-10.0, 0.0, -20.0}, {10.0, 0.0, -70.0}));
  EXPECT_FALSE(pile.Blocks({-10.0, 0.0, -10.0}, {10.0, 0.0, -50.0}));
  EXPECT_TRUE(pile.Blocks({0.0, 0.0, -30.0}, {0.0, 0.0, -60.0}));
}

TEST(LineOfSight, IsBlockedByARidgeAndByObstaclesTheSameBothWays) {
  // A ridge from west to east at the equator, 40 m below the surface. Elsewhere the depth is 140 m.
  std::vector<double> lats, lons{29.9, 30.1};
  std::vector<float> elevations;
  for (int k = -20; k <= 20; ++k) {
    lats.push_back(0.002 * k);
    for (int c = 0; c < 2; ++c) elevations.push_back(k == 0 ? -40.0F : -140.0F);
  }
  const Terrain ridge(Bathymetry(lats, lons, elevations), Datum(0.0, 30.0), 3000.0);
  const std::vector<Obstacle> none;
  EXPECT_FALSE(LineOfSight(ridge, none, {0.0, -1000.0, -80.0}, {0.0, 1000.0, -80.0}));
  EXPECT_TRUE(LineOfSight(ridge, none, {0.0, -1000.0, -30.0}, {0.0, 1000.0, -30.0}));
  EXPECT_TRUE(LineOfSight(ridge, none, {-1000.0, 800.0, -80.0}, {1000.0, 800.0, -80.0}));
  EXPECT_FALSE(LineOfSight(ridge, none, {0.0, 500.0, -150.0}, {0.0, 500.0, -10.0}));
  const std::vector<Obstacle> sphere{{Obstacle::Kind::kSphere, {0.0, 800.0, -80.0}, 20.0, 0.0}};
  EXPECT_FALSE(LineOfSight(ridge, sphere, {-1000.0, 800.0, -80.0}, {1000.0, 800.0, -80.0}));
  const Terrain flat(120.0);
  EXPECT_TRUE(LineOfSight(flat, none, {0.0, 0.0, -119.0}, {4000.0, 0.0, -1.0}));
  EXPECT_FALSE(LineOfSight(flat, none, {0.0, 0.0, -121.0}, {4000.0, 0.0, -1.0}));
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> place(-2500.0, 2500.0), depth(-140.0, 0.0);
  int blocked = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3<double> a{place(random), place(random), depth(random)};
    const Vec3<double> b{place(random), place(random), depth(random)};
    const bool sees = LineOfSight(ridge, sphere, a, b);
    EXPECT_EQ(sees, LineOfSight(ridge, sphere, b, a));
    blocked += sees ? 0 : 1;
  }
  EXPECT_GT(blocked, 50);
  EXPECT_LT(blocked, 450);
}

}  // namespace
}  // namespace stg::dynamics

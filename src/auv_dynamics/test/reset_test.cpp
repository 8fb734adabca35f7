#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "physics.hpp"

namespace stg::dynamics {
namespace {

constexpr std::array<ResetStage, 3> kStages{ResetStage::kEasy, ResetStage::kMedium,
                                            ResetStage::kHard};

void ExpectWithin(double value, const config::Interval& interval) {
  EXPECT_GE(value, interval.lo - 1e-12);
  EXPECT_LE(value, interval.hi + 1e-12);
}

TEST(Reset, DrawsLieInTheIntervalsOfEachStage) {
  // The numbers of Table S2 and of the release's easy stage.
  const config::Interval radius[3] = {{0.05, 0.20}, {0.25, 0.55}, {0.45, 0.75}};
  const config::Interval distance[3] = {{0.08, 0.20}, {0.25, 0.45}, {0.40, 0.70}};
  const config::Interval speed[3] = {{0.001, 0.004}, {0.003, 0.008}, {0.006, 0.014}};
  World world(QuietScenario(4));
  for (size_t k = 0; k < kStages.size(); ++k) {
    for (std::uint32_t e = 0; e < 2000; ++e) {
      const int lane = static_cast<int>(e) % kLanes;
      world.Reset(lane, 1, e, kStages[k]);
      const Vec3<double> p_WT = Lane(world.target(0).p_WT, lane);
      ExpectWithin(Norm(p_WT), radius[k]);
      ExpectWithin(Norm(Lane(world.target(0).v_WT, lane)), speed[k]);
      for (int i = 0; i < 4; ++i) {
        const Vec3<double> p = Lane(world.vehicle(i).p_WB, lane);
        ExpectWithin(Norm(p - p_WT), distance[k]);
        EXPECT_LE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 0.9);
        for (int j = 0; j < i; ++j) {
          EXPECT_GE(Norm(p - Lane(world.vehicle(j).p_WB, lane)), 0.10);
        }
      }
    }
  }
}

TEST(Reset, RadiiAndSpeedsAreUniformInTheirIntervals) {
  World world(QuietScenario(1));
  constexpr int kDraws = 20000;
  double radius = 0.0, distance = 0.0, speed = 0.0;
  for (std::uint32_t e = 0; e < kDraws; ++e) {
    world.Reset(0, 2, e, ResetStage::kEasy);
    const Vec3<double> p_WT = Lane(world.target(0).p_WT, 0);
    radius += Norm(p_WT) / kDraws;
    distance += Norm(Lane(world.vehicle(0).p_WB, 0) - p_WT) / kDraws;
    speed += Norm(Lane(world.target(0).v_WT, 0)) / kDraws;
  }
  const double five = 5.0 / std::sqrt(12.0 * kDraws);
  EXPECT_NEAR(radius, 0.125, five * 0.15);
  EXPECT_NEAR(distance, 0.14, five * 0.12);
  EXPECT_NEAR(speed, 0.0025, five * 0.003);
}

/// Octant counts and mean of unit vectors.
struct Directions {
  std::array<int, 8> octant{};
  Vec3<double> sum;
  double z2 = 0.0;
  int n = 0;

  void Add(const Vec3<double>& a) {
    const Vec3<double> unit = a * (1.0 / Norm(a));
    sum += unit;
    z2 += unit.z * unit.z;
    ++n;
    ++octant[static_cast<size_t>((a.x > 0 ? 1 : 0) + (a.y > 0 ? 2 : 0) + (a.z > 0 ? 4 : 0))];
  }
  void ExpectUniform() const {
    const double five = 5.0 * std::sqrt(n / 3.0);
    EXPECT_LT(std::max({std::abs(sum.x), std::abs(sum.y), std::abs(sum.z)}), five);
    // The z of a uniform direction is uniform in [-1, 1], so z^2 has mean 1/3, variance 4/45.
    EXPECT_NEAR(z2, n / 3.0, 5.0 * std::sqrt(n * 4.0 / 45.0));
    double chi2 = 0.0;
    for (const int count : octant) chi2 += (count - n / 8.0) * (count - n / 8.0) / (n / 8.0);
    EXPECT_LT(chi2, 29.9);  // 7 degrees of freedom, 1 in 10,000
  }
};

TEST(Reset, DirectionsAreUniformOnTheSphere) {
  World world(QuietScenario(2));
  Directions position, velocity, vehicle;
  for (std::uint32_t e = 0; e < 20000; ++e) {
    world.Reset(0, 3, e, ResetStage::kEasy);
    position.Add(Lane(world.target(0).p_WT, 0));
    velocity.Add(Lane(world.target(0).v_WT, 0));
    vehicle.Add(Lane(world.vehicle(1).p_WB, 0) - Lane(world.target(0).p_WT, 0));
  }
  position.ExpectUniform();
  velocity.ExpectUniform();
  vehicle.ExpectUniform();
}

TEST(Reset, VehiclesStartAtRestAndLevelWhateverCameBefore) {
  for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicit}) {
    WorldScenario scenario = QuietScenario(2);
    scenario.world.vehicle.integrator = integrator;
    World world(scenario);
    std::vector<Wrench<Pack>> tau = NoForce(2);
    for (auto& t : tau) {
      t = {{Pack(20.0), Pack(-9.0), Pack(5.0)}, {Pack(2.0), Pack(6.0), Pack(-7.0)}};
    }
    world.Reset(0, 4, 0, ResetStage::kMedium);
    for (int k = 0; k < 50; ++k) world.Step(tau);
    EXPECT_GT(Norm(world.Nav(0, 0).w_WB_B), 0.1);
    world.Reset(0, 4, 1, ResetStage::kMedium);
    for (int i = 0; i < 2; ++i) {
      const NavState nav = world.Nav(0, i);
      EXPECT_EQ(nav.stamp, 0);
      EXPECT_EQ(Norm(nav.v_WB_B), 0.0);
      EXPECT_EQ(Norm(nav.w_WB_B), 0.0);
      EXPECT_EQ(nav.q_WB[0], 1.0);
      const Mat3<double> R = RotationOf(nav.q_WB);
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          EXPECT_EQ(R.m[r][c], r == c ? 1.0 : 0.0);
          EXPECT_EQ(Lane(world.vehicle(i).R_WB.m[r][c], 0), R.m[r][c]);
        }
      }
      EXPECT_EQ(Norm(Lane(world.vehicle(i).v_WB, 0)), 0.0);
    }
    EXPECT_EQ(world.step(0), 0U);
    EXPECT_EQ(world.episode(0), 1U);
  }
}

TEST(Reset, SameSeedAndEpisodeGiveTheSameStartInEveryLane) {
  World world(QuietScenario(4));
  for (int lane = 0; lane < kLanes; ++lane) world.Reset(lane, 77, 5, ResetStage::kHard);
  World other(QuietScenario(4));
  other.Reset(0, 77, 5, ResetStage::kHard);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(Norm(world.Nav(lane, i).p_WB - other.Nav(0, i).p_WB), 0.0);
    }
    EXPECT_EQ(Norm(Lane(world.target(0).v_WT, lane) - Lane(other.target(0).v_WT, 0)), 0.0);
  }
}

TEST(Reset, AnotherSeedOrEpisodeGivesAnotherStart) {
  World world(QuietScenario(1));
  const auto start = [&](std::uint64_t seed, std::uint32_t episode) {
    world.Reset(0, seed, episode, ResetStage::kMedium);
    return Lane(world.target(0).p_WT, 0);
  };
  const Vec3<double> a = start(1, 1);
  EXPECT_GT(Norm(a - start(1, 2)), 1e-6);
  EXPECT_GT(Norm(a - start(2, 1)), 1e-6);
  EXPECT_EQ(Norm(a - start(1, 1)), 0.0);
}

TEST(Reset, VehiclesStartAroundTheTargetTheyAreTaskedWith) {
  WorldScenario scenario = QuietScenario(6);
  scenario.world.target.count = 3;
  World world(scenario);
  for (std::uint32_t e = 0; e < 200; ++e) {
    world.Reset(0, 6, e, ResetStage::kMedium);
    for (int i = 0; i < 6; ++i) {
      const Vec3<double> p_WT = Lane(world.target(i % 3).p_WT, 0);
      ExpectWithin(Norm(world.Nav(0, i).p_WB - p_WT), {0.25, 0.45});
    }
  }
}

}  // namespace
}  // namespace stg::dynamics

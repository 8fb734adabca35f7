#include "stg_agent/controllers/pursuit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace stg::agent {
namespace {

using V = Vec3<double>;

/// Neighbours at these offsets from the AUV.
template <class T>
std::vector<NeighbourSight<T>> At(const std::vector<Vec3<T>>& offsets) {
  std::vector<NeighbourSight<T>> sights(offsets.size());
  for (std::size_t j = 0; j < offsets.size(); ++j) sights[j].r_BN_W = offsets[j];
  return sights;
}

TEST(Pursuit, HoldsTheStandoffAndMovesWithTheTarget) {
  const dynamics::VehicleConfig vehicle;
  const PursuitOptions o;
  double a[3];
  PursuitAction<double>(o, vehicle, V{0.0, o.standoff_m, 0.0}, V{0.01, 0.0, -0.02}, nullptr, 0, a);
  EXPECT_NEAR(a[0] * vehicle.max_velocity_mps[0], 0.01, 1e-15);
  EXPECT_NEAR(a[1], 0.0, 1e-15);
  EXPECT_NEAR(a[2] * vehicle.max_velocity_mps[2], -0.02, 1e-15);
}

TEST(Pursuit, ClosesWithTheGainAndIsCappedPerAxis) {
  const dynamics::VehicleConfig vehicle;
  const PursuitOptions o;
  double a[3];
  PursuitAction<double>(o, vehicle, V{0.03, 0.0, 0.04}, V{}, nullptr, 0, a);
  EXPECT_NEAR(a[0] * 1.5, 4.66 * (0.05 - 0.009) * 0.6, 1e-15);
  EXPECT_NEAR(a[2] * 0.5, 4.66 * (0.05 - 0.009) * 0.8, 1e-15);
  PursuitAction<double>(o, vehicle, V{-9.0, 9.0, 0.0}, V{}, nullptr, 0, a);
  EXPECT_DOUBLE_EQ(a[0], -0.75);
  EXPECT_DOUBLE_EQ(a[1], 0.75);
}

TEST(Pursuit, NeighboursRepelWithinTheirRangeOnly) {
  const dynamics::VehicleConfig vehicle;
  PursuitSeparatedOptions o;
  double a[3], b[3];
  const V target{0.5, 0.0, 0.0};
  const auto far = At<double>({{0.0, 0.030001, 0.0}});
  PursuitAction<double>(o, vehicle, target, V{}, nullptr, 0, a);
  PursuitAction<double>(o, vehicle, target, V{}, far.data(), 1, b);
  EXPECT_EQ(a[1], b[1]);
  const auto near = At<double>({{0.0, 0.01, 0.0}});
  PursuitAction<double>(o, vehicle, target, V{}, near.data(), 1, b);
  EXPECT_NEAR((b[1] - a[1]) * 0.5, -2.0 * (0.03 - 0.01), 1e-15);
  EXPECT_EQ(a[0], b[0]);
}

TEST(Pursuit, CloseToTheTargetRepulsionLeavesTheDistanceAlone) {
  const dynamics::VehicleConfig vehicle;
  const PursuitSeparatedOptions o;
  const V target{o.standoff_m, 0.0, 0.0};
  const auto neighbours = At<double>({{0.01, 0.01, 0.0}, {-0.005, 0.0, 0.012}});
  double a[3];
  PursuitAction<double>(o, vehicle, target, V{}, neighbours.data(), 2, a);
  EXPECT_NEAR(a[0], 0.0, 1e-15);
  EXPECT_LT(a[1], -1e-3);
  EXPECT_LT(a[2], -1e-3);
}

TEST(Pursuit, ZeroOffsetsAreFiniteAndRepelNothing) {
  const PursuitSeparatedOptions o;
  const auto zero = At<double>({{}});
  double a[3];
  PursuitAction<double>(o, dynamics::VehicleConfig(), V{}, V{}, zero.data(), 1, a);
  for (const double x : a) EXPECT_EQ(x, 0.0);
}

TEST(Pursuit, PacksAndScalarsAgreeBitForBit) {
  const PursuitSeparatedOptions o;
  for (int n = 0; n < 200; ++n) {
    const double t = 0.01 * n;
    const V r{0.1 * std::sin(7 * t), 0.2 * t - 0.1, 0.03}, v{0.01, -t * 0.01, 0.0};
    const V near[] = {{0.01 * t, 0.005, -0.01}, {0.02, 0.0, 0.01 * t}};
    const auto one = At<double>({near[0], near[1]});
    const auto packs = At<Pack>({Broadcast(near[0]), Broadcast(near[1])});
    double a[3];
    Pack b[3];
    PursuitAction<double>(o, dynamics::VehicleConfig(), r, v, one.data(), 2, a);
    PursuitAction<Pack>(o, dynamics::VehicleConfig(), Broadcast(r), Broadcast(v), packs.data(), 2,
                        b);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(a[k], Lane(b[k], kLanes - 1));
  }
}

TEST(Pursuit, ApproachIsUnhurriedAndTheHoldStaysStiff) {
  PursuitOptions o;
  o.gain_per_s = 3.0;
  o.approach_speed_mps = 0.01;
  o.approach_gain_per_s = 0.5;
  const dynamics::VehicleConfig vehicle;
  // Distance beyond the standoff, and the speed that it leads to. The two laws meet at 0.004 m.
  for (const auto& [error, speed] : {std::pair{-0.002, -0.006}, {0.002, 0.006}, {0.1, 0.06}}) {
    double a[3];
    PursuitAction<double>(o, vehicle, V{0.0, o.standoff_m + error, 0.0}, V{}, nullptr, 0, a);
    EXPECT_NEAR(a[1] * vehicle.max_velocity_mps[1], speed, 1e-12) << error;
  }
}

TEST(Pursuit, ATargetAtTheWallIsTakenToStandOffIt) {
  const V p_WB{0.97, 0.0, -0.99};
  V r_BT_W{0.025, 0.4, -0.01}, v_WT{0.02, 0.01, -0.03};
  KeepFromWalls(1.0, 0.015, p_WB, &r_BT_W, &v_WT);
  // The target is at (0.995, 0.4, -1). Its x and z are beyond 0.985, its y is not.
  EXPECT_NEAR(r_BT_W.x, 0.985 - 0.97, 1e-15);
  EXPECT_NEAR(r_BT_W.y, 0.4, 1e-15);
  EXPECT_NEAR(r_BT_W.z, 0.99 - 0.985, 1e-15);
  EXPECT_EQ(v_WT.x, 0.0);
  EXPECT_EQ(v_WT.y, 0.01);
  EXPECT_EQ(v_WT.z, 0.0);
}

TEST(Pursuit, WithoutAMarginTheWallChangesNothing) {
  V r_BT_W{0.025, 0.4, -0.01}, v_WT{0.02, 0.01, -0.03};
  KeepFromWalls(1.0, 0.0, V{0.97, 0.0, -0.99}, &r_BT_W, &v_WT);
  EXPECT_EQ(r_BT_W.x, 0.025);
  EXPECT_EQ(v_WT.z, -0.03);
}

TEST(Pursuit, FeedforwardScalesTheTargetsVelocityAlone) {
  PursuitOptions o;
  o.feedforward = 1.5;
  const dynamics::VehicleConfig vehicle;
  double a[3];
  PursuitAction<double>(o, vehicle, V{0.0, o.standoff_m, 0.0}, V{0.02, 0.0, 0.0}, nullptr, 0, a);
  EXPECT_DOUBLE_EQ(a[0] * vehicle.max_velocity_mps[0], 0.03);
  EXPECT_DOUBLE_EQ(a[1], 0.0);
}

}  // namespace
}  // namespace stg::agent

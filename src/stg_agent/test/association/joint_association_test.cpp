// Probabilities of joint association, and what the filter makes of them.

#include "stg_agent/estimation/joint_association.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "association/unlabelled.hpp"

namespace stg::agent {
namespace {

double OddsOf(const LookOdds& odds, int j, int t) {
  return odds[static_cast<std::size_t>(j)][static_cast<std::size_t>(t)];
}

/// Sum of the products over all joint associations from detection j on, by trying all of them;
/// `pair` gets the part in which detection d is of target c.
double Sum(const LookOdds& odds, int detections, int targets, int j, unsigned used, int d, int c,
           double* pair) {
  if (j == detections) {
    *pair = 0.0;
    return 1.0;
  }
  double sum = Sum(odds, detections, targets, j + 1, used, d, c, pair);
  for (int t = 0; t < targets; ++t) {
    if ((used >> t & 1U) != 0U) continue;
    double with = 0.0;
    const double rest = Sum(odds, detections, targets, j + 1, used | 1U << t, d, c, &with);
    sum += OddsOf(odds, j, t) * rest;
    *pair += OddsOf(odds, j, t) * (j == d && t == c ? rest : with);
  }
  return sum;
}

TEST(JointAssociation, TheProbabilityIsThatOfAllJointAssociations) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> value(-3.0, 9.0);
  for (int trial = 0; trial < 200; ++trial) {
    const int detections = 1 + trial % 4, targets = 1 + trial / 4 % 6;
    LookOdds odds{};
    for (auto& row : odds) {
      for (double& o : row) o = std::max(0.0, std::exp(value(random)) - 1.0);
    }
    const int d = trial % detections, c = trial % targets;
    double pair = 0.0;
    const double all = Sum(odds, detections, targets, 0, 0U, d, c, &pair);
    const double o = OddsOf(odds, d, c);
    const double rivals = RivalsOf(odds, detections, targets, d, c);
    EXPECT_NEAR(o / (o + 1.0 + rivals), pair / all, 1e-9) << detections << "x" << targets;
  }
}

TEST(JointAssociation, OneRivalCountsWithItsOdds) {
  LookOdds two_targets{}, two_detections{};
  two_targets[0][0] = 30.0;
  two_targets[0][1] = 20.0;
  EXPECT_NEAR(RivalsOf(two_targets, 1, 2, 0, 0), 20.0, 1e-9);
  two_detections[0][0] = 30.0;
  two_detections[1][0] = 20.0;
  EXPECT_NEAR(RivalsOf(two_detections, 2, 1, 0, 0), 20.0, 1e-9);
}

TEST(JointAssociation, TargetsFarApartAreNoRivals) {
  LookOdds odds{};
  for (std::size_t t = 0; t < 5; ++t) odds[t][t] = 1e6;
  for (int t = 0; t < 5; ++t) EXPECT_EQ(RivalsOf(odds, 5, 5, t, t), 0.0);
}

TEST(JointAssociation, ManyTargetsCountAsIfAllRivalsWereFree) {
  LookOdds odds{};
  for (std::size_t t = 0; t < 10; ++t) odds[0][t] = odds[1][t] = 2.0;
  EXPECT_EQ(RivalsOf(odds, 2, 10, 0, 0), 2.0 * 9 + 2.0);
  double pair = 0.0;
  const double all = Sum(odds, 2, 10, 0, 0U, 0, 0, &pair);
  EXPECT_LT(2.0 / (2.0 + 1.0 + 20.0), pair / all) << "less sure than the exact probability";
}

/// A position, which is of a target with the probability w, moves the estimate by w times the
/// Kalman gain, and leaves the covariance of the mixture of both cases (Bar-Shalom and Tse 1975).
TEST(JointAssociation, ADetectionCountsWithItsProbability) {
  const AgentModel s = UnlabelledModel("position");
  const double std_m = 10.0, noise_m = 5.0, off_m = 8.0, rivals = 3e6;
  const auto filter = TargetFilters().Make(s.track.filter, s, 0);
  filter->Clear();
  filter->Start({0.0, 0.0, -40.0}, std_m, 0);
  filter->Settle(0, {});
  const TargetBelief before = filter->belief();
  const dynamics::Detection d = PositionAt(0, before.p_WT + Vec3<double>{off_m, 0.0, 0.0}, noise_m);
  const double odds = std::exp(filter->Fit(d, 0).gain);
  filter->Assign(d, 0, rivals);
  filter->Settle(0, {});
  const double w = odds / (odds + 1.0 + rivals);
  ASSERT_GT(w, 0.1);
  ASSERT_LT(w, 0.9);
  const double P = before.P_WT.xx, K = P / (P + noise_m * noise_m), moved = K * off_m;
  EXPECT_NEAR(filter->belief().p_WT.x, w * moved, 1e-9);
  EXPECT_NEAR(filter->belief().P_WT.xx, P - w * K * P + w * (1.0 - w) * moved * moved, 1e-9);
}

}  // namespace
}  // namespace stg::agent

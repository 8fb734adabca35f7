// Gate and assignment of unlabelled detections, against closed forms and brute force.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "association/unlabelled.hpp"

namespace stg::agent {
namespace {

/// Distribution function of chi-squared.
double ChiSquared(int freedom, double x) {
  const double near = std::erf(std::sqrt(0.5 * x));
  if (freedom == 1) return near;
  if (freedom == 2) return 1.0 - std::exp(-0.5 * x);
  return near - std::sqrt(2.0 * x / kPi) * std::exp(-0.5 * x);
}

TEST(Association, TheGateIsThe99PercentQuantileOfChiSquared) {
  for (int n = 1; n <= 3; ++n) EXPECT_NEAR(ChiSquared(n, Gate(n)), 0.99, 1e-12) << n;
}

std::unique_ptr<TargetFilter> Started(const AgentModel& s, const Vec3<double>& p_WT, double std_m) {
  auto filter = TargetFilters().Make(s.track.filter, s, 0);
  filter->Clear();
  filter->Start(p_WT, std_m, 0);
  filter->Settle(0, {});
  return filter;
}

dynamics::Detection RangeFrom(const Vec3<double>& p_WO, double range_m, double std_m) {
  dynamics::Detection d;
  d.kind = dynamics::MeasurementKind::kRange;
  d.p_WO = d.p_WT = p_WO;
  d.range_m = range_m;
  d.range_std_m = std_m;
  return d;
}

/// A place that the target may have, as the estimate says.
Vec3<double> Draw(const TargetBelief& b, std::mt19937_64* random) {
  std::normal_distribution<double> normal;
  return b.p_WT + Vec3<double>{std::sqrt(b.P_WT.xx) * normal(*random),
                               std::sqrt(b.P_WT.yy) * normal(*random),
                               std::sqrt(b.P_WT.zz) * normal(*random)};
}

/// Checks a share of 0.99, within five deviations of a binomial.
void ExpectShareInGate(int inside, int draws) {
  EXPECT_NEAR(static_cast<double>(inside) / draws, 0.99, 5.0 * std::sqrt(0.99 * 0.01 / draws));
}

TEST(Association, OneDetectionInAHundredOfTheTargetIsOutsideTheGate) {
  constexpr int kDraws = 20000;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const Vec3<double> datum{100.0, -50.0, -40.0};
  {
    const AgentModel s = UnlabelledModel("position");
    const auto filter = Started(s, datum, 20.0);
    int inside = 0;
    for (int k = 0; k < kDraws; ++k) {
      const Vec3<double> p = Draw(filter->belief(), &random);
      const Vec3<double> noise{normal(random), normal(random), normal(random)};
      const DetectionFit fit = filter->Fit(PositionAt(0, p + noise * 3.0, 3.0), 0);
      inside += fit.distance2 <= Gate(3);
    }
    ExpectShareInGate(inside, kDraws);
  }
  const AgentModel s = UnlabelledModel("range");
  const auto filter = Started(s, datum, 10.0);
  const Vec3<double> p_WO{-200.0, -50.0, -30.0};
  int inside = 0;
  for (int k = 0; k < kDraws; ++k) {
    const double range_m = Norm(Draw(filter->belief(), &random) - p_WO) + 4.0 * normal(random);
    inside += filter->Fit(RangeFrom(p_WO, range_m, 4.0), 0).distance2 <= Gate(1);
  }
  ExpectShareInGate(inside, kDraws);
}

TEST(Association, TheGainIsTheRatioOfTheDensities) {
  const AgentModel s = UnlabelledModel("range");
  const Vec3<double> p_WO{0.0, 0.0, -40.0};
  const auto filter = Started(s, {300.0, 0.0, -40.0}, 10.0);
  const TargetBelief b = filter->belief();
  const double level = b.p_WT.x, rise = b.p_WT.z - p_WO.z, r = std::hypot(level, rise);
  // The mean range and its second order, as docs/estimation.md has them.
  const double along = (level * level * b.P_WT.xx + rise * rise * b.P_WT.zz) / (r * r);
  const double bend = (b.P_WT.trace() - along) / (2.0 * r);
  const double variance = along + 16.0 + 2.0 * bend * bend, off = 7.0;
  const DetectionFit fit = filter->Fit(RangeFrom(p_WO, r + bend + off, 4.0), 0);
  EXPECT_TRUE(fit.started);
  EXPECT_NEAR(fit.distance2, off * off / variance, 1e-9);
  const double false_share = 1e-3;  // no detection is trusted completely
  const double density = std::exp(-0.5 * off * off / variance) / std::sqrt(2.0 * kPi * variance);
  EXPECT_NEAR(fit.gain, std::log((1.0 - false_share) * density / (false_share / s.sensing.range_m)),
              1e-9);
}

TEST(Association, AnEstimateThatIsMissingFitsNothing) {
  const AgentModel s = UnlabelledModel("range");
  const auto filter = TargetFilters().Make(s.track.filter, s, 0);
  filter->Clear();
  const DetectionFit fit = filter->Fit(RangeFrom({}, 100.0, 4.0), 0);
  EXPECT_FALSE(fit.started);
  EXPECT_FALSE(InGate(fit, dynamics::MeasurementKind::kRange));
}

TEST(Association, ALateDetectionIsComparedWithTheEstimateAtItsTime) {
  const AgentModel s = UnlabelledModel("position");
  const auto filter = Started(s, {0.0, 0.0, -40.0}, 5.0);
  for (int k = 1; k <= 40; ++k) {  // 1 m/s to the east
    const dynamics::Detection d =
        PositionAt(k * kSecond_ns, {static_cast<double>(k), 0.0, -40.0}, 1.0);
    filter->Detect(d);
    filter->Settle(d.stamp, {});
  }
  dynamics::Detection late = PositionAt(20 * kSecond_ns, {20.0, 0.0, -40.0}, 1.0);
  EXPECT_LE(filter->Fit(late, 1).distance2, Gate(3));
  late.p_WT.x = 40.0;
  EXPECT_GT(filter->Fit(late, 1).distance2, Gate(3));
}

/// The largest sum of gains, by trying everything.
double Best(const std::vector<std::vector<double>>& gain, std::size_t row, unsigned used) {
  if (row == gain.size()) return 0.0;
  double best = Best(gain, row + 1, used);
  for (std::size_t t = 0; t < gain[row].size(); ++t) {
    if ((used >> t & 1U) != 0U || gain[row][t] <= 0.0) continue;
    best = std::max(best, gain[row][t] + Best(gain, row + 1, used | 1U << t));
  }
  return best;
}

TEST(Association, FindsTheBestAssignmentOfALook) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> value(-8.0, 12.0);
  for (int trial = 0; trial < 400; ++trial) {
    const int detections = 1 + trial % 5, targets = 1 + trial / 5 % 6;
    std::vector<std::vector<double>> gain(static_cast<std::size_t>(detections));
    for (auto& row : gain) {
      for (int t = 0; t < targets; ++t) row.push_back(value(random));
    }
    LookAssignment assignment;
    assignment.Solve(detections, targets, [&](int j, int t) {
      return gain[static_cast<std::size_t>(j)][static_cast<std::size_t>(t)];
    });
    double sum = 0.0;
    std::vector<int> taken;
    for (int j = 0; j < detections; ++j) {
      const int t = assignment.target_of(j);
      if (t < 0) continue;
      const double g = gain[static_cast<std::size_t>(j)][static_cast<std::size_t>(t)];
      EXPECT_GT(g, 0.0);
      sum += g;
      taken.push_back(t);
    }
    std::sort(taken.begin(), taken.end());
    EXPECT_EQ(std::unique(taken.begin(), taken.end()), taken.end()) << "one detection a target";
    EXPECT_NEAR(sum, Best(gain, 0, 0U), 1e-9);
  }
}

}  // namespace
}  // namespace stg::agent

#include "acoustic_channel/propagation/fading.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "acoustic_channel/modem/error_rate.hpp"
#include "acoustic_channel/propagation/bursts.hpp"
#include "acoustic_channel/propagation/propagation.hpp"

namespace stg::acoustics {
namespace {

constexpr TimeNs kSecond = 1'000'000'000;

TEST(Shadowing, HasTheVarianceAndMemoryOfTheSection) {
  PropagationConfig config;
  config.shadowing_db = 3.0;
  config.shadowing_time_s = 10.0;
  Shadowing shadowing(config, 2);
  shadowing.Reset(4, 0);
  constexpr int kSteps = 400000, kLag = 5;
  std::vector<double> x;
  for (int k = 0; k < kSteps; ++k) x.push_back(shadowing.LevelDb(k % 2, 1 - k % 2, k * kSecond));
  double sum = 0.0, square = 0.0, product = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    sum += x[k];
    square += x[k] * x[k];
    if (k >= kLag) product += x[k] * x[k - kLag];
  }
  // The values are worth 20,000 independent ones.
  EXPECT_NEAR(sum / kSteps, 0.0, 0.08);
  EXPECT_NEAR(square / kSteps, 9.0, 0.3);
  EXPECT_NEAR(product / square, std::exp(-0.5), 0.02);
}

TEST(Shadowing, UnevenTimesHaveTheSameMemory) {
  PropagationConfig config;
  double product = 0.0, square = 0.0;
  for (std::uint64_t seed = 0; seed < 40000; ++seed) {
    Shadowing shadowing(config, 2);
    shadowing.Reset(seed, 0);
    const double first = shadowing.LevelDb(0, 1, kSecond);
    shadowing.LevelDb(0, 1, 3 * kSecond);
    shadowing.LevelDb(0, 1, 4 * kSecond);
    const double last = shadowing.LevelDb(0, 1, 11 * kSecond);
    product += first * last;
    square += first * first;
  }
  EXPECT_NEAR(product / square, std::exp(-1.0), 0.02);
}

TEST(Shadowing, ALinkIsBothWaysOneAndDoesNotDependOnOthers) {
  const PropagationConfig config;
  Shadowing alone(config, 5), among(config, 5);
  alone.Reset(7, 2);
  among.Reset(7, 2);
  for (TimeNs t = 0; t < 100 * kSecond; t += kSecond) {
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 5; ++j) {
        if (i != j && !(i == 1 && j == 3) && !(i == 3 && j == 1)) among.LevelDb(i, j, t);
      }
    }
    EXPECT_EQ(alone.LevelDb(1, 3, t), among.LevelDb(3, 1, t));
    EXPECT_EQ(alone.LevelDb(1, 3, t), alone.LevelDb(3, 1, t));
    EXPECT_NE(among.LevelDb(1, 3, t), among.LevelDb(1, 2, t));
  }
}

TEST(RicianFading, MeanPowerIsOneAndTheSpreadFollowsK) {
  for (double K : {0.0, 1.0, 10.0, 100.0}) {
    double sum = 0.0, square = 0.0;
    constexpr int kDraws = 100000;
    for (int i = 0; i < kDraws; ++i) {
      const double power = DbToRatio(RicianDb(K, 5, 0, static_cast<std::uint32_t>(i), 1, 2));
      sum += power;
      square += power * power;
    }
    const double mean = sum / kDraws;
    EXPECT_NEAR(mean, 1.0, 0.02);
    // Variance of |h|^2: (1 + 2K) / (1 + K)^2.
    EXPECT_NEAR(square / kDraws - mean * mean, (1.0 + 2.0 * K) / ((1.0 + K) * (1.0 + K)), 0.04);
  }
  EXPECT_EQ(RicianDb(kSteadyRicianK, 5, 0, 0, 1, 2), 0.0);
}

TEST(RicianFading, AveragesToTheClosedFormsOfBitErrors) {
  double rice = 0.0, rayleigh = 0.0;
  constexpr int kDraws = 400000;
  for (int i = 0; i < kDraws; ++i) {
    const auto sequence = static_cast<std::uint32_t>(i);
    rice += NoncoherentFskBitError(10.0 * DbToRatio(RicianDb(10.0, 1, 0, sequence, 0, 1)));
    rayleigh += BpskBitError(10.0 * DbToRatio(RicianDb(0.0, 2, 0, sequence, 0, 1)));
  }
  EXPECT_NEAR(rice / kDraws, RicianNoncoherentFskBitError(10.0, 10.0), 3e-4);
  EXPECT_NEAR(rayleigh / kDraws, RayleighBpskBitError(10.0), 4e-4);
}

TEST(RicianFading, PacketsReceiversAndEpisodesDrawApart) {
  EXPECT_EQ(RicianDb(1.0, 1, 2, 3, 4, 5), RicianDb(1.0, 1, 2, 3, 4, 5));
  EXPECT_NE(RicianDb(1.0, 1, 2, 3, 4, 5), RicianDb(1.0, 1, 2, 3, 4, 6));
  EXPECT_NE(RicianDb(1.0, 1, 2, 3, 4, 5), RicianDb(1.0, 1, 2, 3, 5, 4));
  EXPECT_NE(RicianDb(1.0, 1, 2, 3, 4, 5), RicianDb(1.0, 1, 2, 4, 4, 5));
  EXPECT_NE(RicianDb(1.0, 1, 2, 3, 4, 5), RicianDb(1.0, 1, 3, 3, 4, 5));
  EXPECT_NE(RicianDb(1.0, 1, 2, 3, 4, 5), RicianDb(1.0, 2, 2, 3, 4, 5));
}

TEST(Bursts, SpansAreExponentialWithTheMeansOfTheSection) {
  NoiseConfig config;
  config.burst_every_s = 4.0;
  config.burst_length_s = 1.0;
  Bursts bursts(config, 1);
  bursts.Reset(9, 1);
  double sum[2] = {}, square[2] = {};
  int count[2] = {};
  TimeNs t = 0;
  for (int i = 0; i < 80000; ++i) {
    const Bursts::Span span = bursts.At(0, t);
    ASSERT_EQ(span.begin, t);
    ASSERT_EQ(span.loud, i % 2 == 1);
    const double s = Seconds(span.end - span.begin);
    sum[span.loud] += s;
    square[span.loud] += s * s;
    ++count[span.loud];
    t = span.end;
  }
  EXPECT_NEAR(sum[0] / count[0], 4.0, 0.06);
  EXPECT_NEAR(sum[1] / count[1], 1.0, 0.015);
  // For an exponential distribution (no memory) the mean square is twice the square of the mean.
  EXPECT_NEAR(square[0] / count[0], 32.0, 1.5);
  EXPECT_NEAR(square[1] / count[1], 2.0, 0.1);
}

TEST(Bursts, TheCourseDoesNotDependOnWhoAsksWhen) {
  NoiseConfig config;
  config.burst_every_s = 4.0;
  Bursts forwards(config, 3), backwards(config, 3);
  forwards.Reset(3, 0);
  backwards.Reset(3, 0);
  int differing = 0;
  for (int k = 0; k <= 1000; ++k) {
    const Bursts::Span a = forwards.At(1, k * kSecond / 5);
    const TimeNs mirrored = (1000 - k) * kSecond / 5;
    const Bursts::Span b = backwards.At(1, mirrored);
    EXPECT_LE(a.begin, k * kSecond / 5);
    EXPECT_GT(a.end, k * kSecond / 5);
    const Bursts::Span again = forwards.At(1, mirrored);
    EXPECT_EQ(again.begin, b.begin);
    EXPECT_EQ(again.end, b.end);
    EXPECT_EQ(again.loud, b.loud);
    differing += forwards.At(2, mirrored).begin != b.begin ? 1 : 0;
  }
  EXPECT_GT(differing, 900);
}

TEST(Bursts, NoneWhereTheSectionHasNone) {
  Bursts bursts({}, 2);
  bursts.Reset(1, 1);
  EXPECT_FALSE(bursts.At(1, 1000000 * kSecond).loud);
}

}  // namespace
}  // namespace stg::acoustics

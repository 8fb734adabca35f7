#include "auv_common/numbers/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

namespace stg {
namespace {

using Philox = r123::Philox4x32;

TEST(Random, PhiloxMatchesThePublishedKnownAnswers) {
  // Salmon et al. 2011, known-answer vectors of philox4x32-10.
  const auto check = [](Philox::ctr_type counter, Philox::key_type key, Philox::ctr_type expected) {
    EXPECT_EQ(Philox()(counter, key), expected);
  };
  check({{0, 0, 0, 0}}, {{0, 0}}, {{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}});
  check({{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}}, {{0xffffffff, 0xffffffff}},
        {{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}});
  check({{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}}, {{0xa4093822, 0x299f31d0}},
        {{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}});
}

TEST(Random, FirstBlockOfTheZeroKeyIsTheKnownAnswer) {
  Random random(0, static_cast<Stream>(0), 0, 0, 0);
  for (const std::uint32_t expected : {0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U}) {
    EXPECT_EQ(random.Bits(), expected);
  }
}

TEST(Random, EveryPartOfTheKeyGivesOtherNumbers) {
  const auto first = [](std::uint64_t seed, Stream stream, std::uint32_t episode,
                        std::uint32_t step, std::uint32_t index) {
    Random random(seed, stream, episode, step, index);
    const std::uint64_t high = random.Bits();
    return (high << 32) | random.Bits();
  };
  const std::vector<std::uint64_t> draws{first(5, Stream::kReset, 1, 2, 3),
                                         first(6, Stream::kReset, 1, 2, 3),
                                         first(5 + (1ULL << 32), Stream::kReset, 1, 2, 3),
                                         first(5, Stream::kTarget, 1, 2, 3),
                                         first(5, Stream::kReset, 2, 2, 3),
                                         first(5, Stream::kReset, 1, 3, 3),
                                         first(5, Stream::kReset, 1, 2, 4)};
  EXPECT_EQ(std::set<std::uint64_t>(draws.begin(), draws.end()).size(), draws.size());
  EXPECT_EQ(draws[0], first(5, Stream::kReset, 1, 2, 3));
}

TEST(Random, UniformFillsTheUnitIntervalEvenly) {
  Random random(7, Stream::kPolicy, 0, 0, 0);
  constexpr int kDraws = 100000, kBins = 50;
  std::array<int, kBins> count{};
  for (int n = 0; n < kDraws; ++n) {
    const double u = random.Uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++count[static_cast<size_t>(u * kBins)];
  }
  double chi2 = 0.0;
  const double expected = static_cast<double>(kDraws) / kBins;
  for (const int c : count) chi2 += (c - expected) * (c - expected) / expected;
  EXPECT_LT(chi2, 94.0);  // 49 degrees of freedom, 1 in 10,000
  EXPECT_GT(chi2, 18.0);
}

TEST(Random, NormalHasTheMomentsOfTheStandardNormal) {
  Random random(8, Stream::kPolicy, 0, 0, 0);
  constexpr int kDraws = 200000;
  double sum[5] = {};
  for (int n = 0; n < kDraws; ++n) {
    double power = 1.0;
    const double x = random.Normal();
    for (double& s : sum) {
      s += power / kDraws;
      power *= x;
    }
  }
  // The variances of x, x^2, x^3, x^4 are 1, 2, 15, 96. The test allows five deviations.
  const double root = 5.0 / std::sqrt(static_cast<double>(kDraws));
  EXPECT_NEAR(sum[1], 0.0, root);
  EXPECT_NEAR(sum[2], 1.0, root * std::sqrt(2.0));
  EXPECT_NEAR(sum[3], 0.0, root * std::sqrt(15.0));
  EXPECT_NEAR(sum[4], 3.0, root * std::sqrt(96.0));
}

TEST(Random, NeighbouringKeysAreUncorrelated) {
  constexpr int kDraws = 50000;
  double steps = 0.0, indices = 0.0, halves = 0.0;
  for (std::uint32_t n = 0; n < kDraws; ++n) {
    Random here(9, Stream::kDetection, 1, n, 4), next(9, Stream::kDetection, 1, n + 1, 4),
        beside(9, Stream::kDetection, 1, n, 5);
    const double x = here.Normal();
    steps += x * next.Normal();
    indices += x * beside.Normal();
    halves += x * here.Normal();
  }
  const double bound = 5.0 * std::sqrt(static_cast<double>(kDraws));
  EXPECT_LT(std::abs(steps), bound);
  EXPECT_LT(std::abs(indices), bound);
  EXPECT_LT(std::abs(halves), bound);
}

}  // namespace
}  // namespace stg

#include <gtest/gtest.h>

#include <cmath>

#include "acoustic_channel/models/extended.hpp"
#include "acoustic_channel/models/range.hpp"

namespace stg::acoustics {
namespace {

ExtendedConfig Config() {
  ExtendedConfig c;
  c.attenuation_per_m = 0.5;
  c.loss_probability = 0.1;
  c.loss_distance_m = 2.0;
  c.freshness_s = 2.0;
  return c;
}

TEST(LinkQuality, RangeQualityHasTheHandComputedValuesOfEq5) {
  EXPECT_DOUBLE_EQ(RangeQuality(0.0, 0.45), 1.0);
  EXPECT_NEAR(RangeQuality(0.15, 0.45), 2.0 / 3.0, 1e-15);
  EXPECT_NEAR(RangeQuality(0.36, 0.45), 0.2, 1e-15);
  EXPECT_EQ(RangeQuality(0.45, 0.45), 0.0);
  EXPECT_EQ(RangeQuality(3.0, 0.45), 0.0);
}

TEST(LinkQuality, LossProbabilityHasItsHandComputedValues) {
  EXPECT_NEAR(LossProbability(0.0, Config()), 0.1, 1e-15);
  EXPECT_NEAR(LossProbability(2.0, Config()), 0.66890850295, 1e-11);  // 1 - 0.9 / e
  EXPECT_NEAR(LossProbability(1.0, Config()), 0.29907929524, 1e-11);  // 1 - 0.9 e^-0.25
  EXPECT_NEAR(LossProbability(100.0, Config()), 1.0, 1e-15);
}

TEST(LinkQuality, ExtendedQualityHasTheHandComputedValuesOfEq6) {
  EXPECT_NEAR(ExtendedQuality(0.0, 0.0, Config()), 0.9, 1e-15);
  // e^-0.5 (attenuation) * 0.9 e^-0.25 (loss) * e^-0.5 (age 1 s of 2 s)
  EXPECT_NEAR(ExtendedQuality(1.0, 1.0, Config()), 0.9 * 0.28650479686, 1e-10);
  // One freshness constant costs a factor e.
  EXPECT_NEAR(ExtendedQuality(0.7, 1.0, Config()) / ExtendedQuality(0.7, 3.0, Config()),
              std::exp(1.0), 1e-12);
}

TEST(LinkQuality, FartherOrOlderIsNeverBetter) {
  double loss = -1.0, range = 2.0, extended = 2.0;
  for (double d = 0.0; d < 5.0; d += 0.01) {
    EXPECT_GE(LossProbability(d, Config()), loss);
    EXPECT_LE(RangeQuality(d, 0.45), range);
    EXPECT_LE(ExtendedQuality(d, 0.3, Config()), extended);
    EXPECT_LE(ExtendedQuality(d, 0.31, Config()), ExtendedQuality(d, 0.3, Config()));
    loss = LossProbability(d, Config());
    range = RangeQuality(d, 0.45);
    extended = ExtendedQuality(d, 0.3, Config());
    for (const double q : {loss, range, extended}) {
      EXPECT_GE(q, 0.0);
      EXPECT_LE(q, 1.0);
    }
  }
}

TEST(LinkQuality, PacksAndScalarsAgreeBitForBit) {
  for (double d = 0.0; d < 4.0; d += 0.037) {
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_EQ(Lane(RangeQuality(Pack(d), 0.45), lane), RangeQuality(d, 0.45));
      EXPECT_EQ(Lane(LossProbability(Pack(d), Config()), lane), LossProbability(d, Config()));
      EXPECT_EQ(Lane(ExtendedQuality(Pack(d), Pack(0.2 * d), Config()), lane),
                ExtendedQuality(d, 0.2 * d, Config()));
    }
  }
}

}  // namespace
}  // namespace stg::acoustics

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "physics.hpp"

namespace stg::dynamics {
namespace {

/// One vehicle that always has its target within range.
WorldScenario SensingScenario() {
  WorldScenario s = QuietScenario(1);
  s.world.vehicle = ReleaseVehicle();
  s.world.sensing.range_m = 10.0;
  return s;
}

/// Binomial acceptance: five standard deviations around the mean.
void ExpectShare(int hits, int draws, double probability) {
  EXPECT_NEAR(hits, draws * probability,
              5.0 * std::sqrt(draws * probability * (1.0 - probability)) + 1e-9);
}

/// Sum of squares of n standard normal numbers, within five deviations.
void ExpectChiSquare(double sum, int n) { EXPECT_NEAR(sum, n, 5.0 * std::sqrt(2.0 * n)); }

TEST(Sensing, DetectsWithinRangeOnly) {
  WorldScenario scenario = SensingScenario();
  scenario.world.sensing.range_m = 0.45;
  World world(scenario);
  Detection detection;
  for (const double d : {0.0, 0.2, 0.4499}) {
    world.Place(0, {{0.1, 0.2, 0.3}}, {{0.1, 0.2 - d, 0.3}}, {{0.0, 0.0, 0.0}});
    EXPECT_TRUE(world.Sense(0, 0, 0, &detection)) << d;
    EXPECT_EQ(detection.p_WT.y, 0.2 - d);
  }
  for (const double d : {0.4501, 0.9}) {
    world.Place(0, {{0.1, 0.2, 0.3}}, {{0.1, 0.2 - d, 0.3}}, {{0.0, 0.0, 0.0}});
    EXPECT_FALSE(world.Sense(0, 0, 0, &detection)) << d;
  }
}

TEST(Sensing, DetectionCarriesStampTargetAndStatedNoise) {
  WorldScenario scenario = SensingScenario();
  scenario.run.agents = 2;
  scenario.world.target.count = 2;
  scenario.world.sensing.noise_std_m = 0.01;
  World world(scenario);
  world.Reset(0, 1, 0, ResetStage::kMedium);
  for (int k = 0; k < 7; ++k) world.Step(NoForce(2));
  Detection detection;
  ASSERT_TRUE(world.Sense(0, 0, 1, &detection));
  EXPECT_EQ(detection.stamp, 700000000);
  EXPECT_EQ(detection.target, 1);
  EXPECT_EQ(detection.std_m, 0.01);
  Detection again;
  ASSERT_TRUE(world.Sense(0, 0, 1, &again));
  EXPECT_EQ(Norm(again.p_WT - detection.p_WT), 0.0);  // two questions give one measurement
  ASSERT_TRUE(world.Sense(0, 1, 1, &again));
  EXPECT_GT(Norm(again.p_WT - detection.p_WT), 0.0);  // another sensor has another error
}

TEST(Sensing, DetectionProbabilityIsMetWithinBinomialBounds) {
  for (const double probability : {0.05, 0.5, 0.9}) {
    WorldScenario scenario = SensingScenario();
    scenario.world.sensing.detection_probability = probability;
    World world(scenario);
    int hits = 0;
    constexpr int kDraws = 20000;
    for (std::uint32_t e = 0; e < kDraws; ++e) {
      world.Reset(0, 5, e, ResetStage::kEasy);
      Detection detection;
      hits += world.Sense(0, 0, 0, &detection) ? 1 : 0;
    }
    ExpectShare(hits, kDraws, probability);
  }
}

TEST(Sensing, DetectionProbabilityZeroAndOneAreCertain) {
  for (const double probability : {0.0, 1.0}) {
    WorldScenario scenario = SensingScenario();
    scenario.world.sensing.detection_probability = probability;
    scenario.world.sensing.noise_std_m = 0.001;
    World world(scenario);
    Detection detection;
    for (std::uint32_t e = 0; e < 1000; ++e) {
      world.Reset(0, 6, e, ResetStage::kEasy);
      EXPECT_EQ(world.Sense(0, 0, 0, &detection), probability == 1.0);
    }
  }
}

TEST(Sensing, NoiseHasTheStatedDeviationAndNoBias) {
  WorldScenario scenario = SensingScenario();
  scenario.world.sensing.noise_std_m = 0.02;
  World world(scenario);
  world.Reset(0, 7, 0, ResetStage::kEasy);
  double squares = 0.0;
  Vec3<double> sum;
  double cross = 0.0;
  constexpr int kDraws = 20000;
  for (int k = 0; k < kDraws; ++k) {
    Detection detection;
    ASSERT_TRUE(world.Sense(0, 0, 0, &detection));
    const Vec3<double> z = (detection.p_WT - Lane(world.target(0).p_WT, 0)) * (1.0 / 0.02);
    squares += Dot(z, z);
    sum += z;
    cross += z.x * z.y + z.y * z.z + z.z * z.x;
    world.Step(NoForce(1));
  }
  ExpectChiSquare(squares, 3 * kDraws);
  const double bound = 5.0 * std::sqrt(kDraws);
  EXPECT_LT(std::max({std::abs(sum.x), std::abs(sum.y), std::abs(sum.z)}), bound);
  EXPECT_LT(std::abs(cross), bound * std::sqrt(3.0));  // components are independent
}

TEST(Sensing, DropoutMakesBlindSpellsOfTheStatedShareAndLength) {
  WorldScenario scenario = SensingScenario();
  scenario.world.sensing.dropout_rate_hz = 0.25;
  scenario.world.sensing.dropout_duration_s = 2.0;
  World world(scenario);
  world.Reset(0, 8, 0, ResetStage::kEasy);
  constexpr int kSlots = 3000, kSlotSteps = 20;
  int blind_slots = 0;
  for (int slot = 0; slot < kSlots; ++slot) {
    int blind = 0;
    for (int k = 0; k < kSlotSteps; ++k) {
      Detection detection;
      blind += world.Sense(0, 0, 0, &detection) ? 0 : 1;
      world.Step(NoForce(1));
    }
    // A spell lasts: the sensor is blind for a whole slot or not at all.
    ASSERT_TRUE(blind == 0 || blind == kSlotSteps) << "slot " << slot;
    blind_slots += blind == 0 ? 0 : 1;
  }
  ExpectShare(blind_slots, kSlots, 1.0 - std::exp(-0.5));
}

TEST(Sensing, CueHasTheStatedDeviationAndIsSharedByAllVehicles) {
  WorldScenario scenario = SensingScenario();
  scenario.run.agents = 3;
  scenario.world.target.count = 2;
  scenario.world.sensing.cue_std_m = 0.05;
  World world(scenario);
  double squares = 0.0;
  constexpr int kDraws = 5000;
  for (std::uint32_t e = 0; e < kDraws; ++e) {
    world.Reset(0, 9, e, ResetStage::kEasy);
    Vec3<double> z[2];
    for (int k = 0; k < 2; ++k) {
      const Cue cue = world.InitialCue(0, 0, k);
      EXPECT_EQ(cue.std_m, 0.05);
      EXPECT_EQ(cue.target, k);
      z[k] = (cue.p_WT - Lane(world.target(k).p_WT, 0)) * (1.0 / 0.05);
      squares += Dot(z[k], z[k]);
      EXPECT_EQ(Norm(world.InitialCue(0, 2, k).p_WT - cue.p_WT), 0.0);
    }
    EXPECT_GT(Norm(z[0] - z[1]), 0.0);
  }
  ExpectChiSquare(squares, 6 * kDraws);
}

TEST(Sensing, CueOfNoUncertaintyIsTheTarget) {
  World world(SensingScenario());
  world.Reset(0, 10, 3, ResetStage::kHard);
  EXPECT_EQ(Norm(world.InitialCue(0, 0, 0).p_WT - Lane(world.target(0).p_WT, 0)), 0.0);
}

}  // namespace
}  // namespace stg::dynamics

#include <gtest/gtest.h>

#include <cmath>

#include "acoustic_channel/water/absorption.hpp"
#include "acoustic_channel/water/noise.hpp"
#include "acoustic_channel/water/sound_speed.hpp"

namespace stg::acoustics {
namespace {

TEST(SoundSpeed, PublishedValuesOfMackenzie) {
  EXPECT_NEAR(MackenzieSoundSpeed(25, 35, 1000), 1550.744, 5e-4);
  EXPECT_NEAR(MackenzieSoundSpeed(27, 35, 10), 1539.1, 0.05);
  EXPECT_NEAR(MackenzieSoundSpeed(25, 35, 20), 1534.6, 0.05);
}

TEST(SoundSpeed, ProfileIsLinearBetweenItsKnotsAndConstantOutside) {
  WaterConfig water;
  water.sound_speed = WaterConfig::SoundSpeed::kProfile;
  water.profile_depths_m = {10.0, 20.0, 50.0, 100.0};
  water.profile_speeds_mps = {1520.0, 1500.0, 1490.0, 1495.0};
  const SoundSpeedProfile profile(water);
  EXPECT_EQ(profile.At(-3.0), 1520.0);
  EXPECT_EQ(profile.At(10.0), 1520.0);
  EXPECT_NEAR(profile.At(15.0), 1510.0, 1e-9);
  EXPECT_NEAR(profile.At(35.0), 1495.0, 1e-9);
  EXPECT_EQ(profile.At(4000.0), 1495.0);
}

TEST(SoundSpeed, SlownessIsTheMeanOfTheReciprocalWhicheverWayOneGoes) {
  WaterConfig water;
  water.sound_speed = WaterConfig::SoundSpeed::kProfile;
  water.profile_depths_m = {0.0, 40.0, 80.0, 120.0};
  water.profile_speeds_mps = {1540.0, 1500.0, 1500.0, 1480.0};
  const SoundSpeedProfile profile(water);
  // Mean of 1/c over a linear piece: ln(c1/c0) / (c1 - c0).
  EXPECT_NEAR(profile.MeanSlowness(0, 40), std::log(1540.0 / 1500.0) / 40.0, 1e-13);
  EXPECT_NEAR(profile.MeanSlowness(45, 70), 1.0 / 1500.0, 1e-15);
  EXPECT_EQ(profile.MeanSlowness(3.0, 117.0), profile.MeanSlowness(117.0, 3.0));
  EXPECT_EQ(profile.MeanSlowness(60.0, 60.0), 1.0 / 1500.0);
}

TEST(Absorption, Thorp) {
  EXPECT_NEAR(ThorpAbsorption(1.0), 0.069, 5e-4);
  EXPECT_NEAR(ThorpAbsorption(10.0), 1.187, 5e-4);
  EXPECT_NEAR(ThorpAbsorption(11.52), 1.528, 5e-4);
  EXPECT_NEAR(ThorpAbsorption(25.0), 6.105, 5e-4);
  EXPECT_NEAR(ThorpAbsorption(50.0), 17.47, 5e-3);
  EXPECT_NEAR(ThorpAbsorption(100.0), 34.07, 5e-3);
}

TEST(Absorption, PublishedValuesOfFrancoisAndGarrison) {
  EXPECT_NEAR(FrancoisGarrisonAbsorption(50.0, 27.0, 35.0, 10.0, 8.1), 10.71, 5e-3);
  EXPECT_NEAR(FrancoisGarrisonAbsorption(100.0, 14.0, 38.5, 0.0, 8.0), 40.0, 0.5);
  EXPECT_NEAR(FrancoisGarrisonAbsorption(100.0, 14.0, 38.5, 2000.0, 8.0), 30.0, 0.5);
  EXPECT_NEAR(FrancoisGarrisonAbsorption(100.0, 14.0, 38.5, 6000.0, 8.0), 16.0, 0.5);
}

TEST(Absorption, TheSectionChoosesTheFormula) {
  WaterConfig water;
  EXPECT_EQ(Absorption(water, 25.0, 100.0), ThorpAbsorption(25.0));
  water.absorption = WaterConfig::Absorption::kFrancoisGarrison;
  water.temperature_c = 5.0;
  EXPECT_EQ(Absorption(water, 25.0, 100.0),
            FrancoisGarrisonAbsorption(25.0, 5.0, 35.0, 100.0, 8.0));
}

TEST(Noise, DensitiesOfWenzInTheFormOfCoates) {
  EXPECT_NEAR(TurbulenceNoise(1.0), 17.0, 6e-3);
  EXPECT_NEAR(ShippingNoise(1.0, 0.5), 39.23, 6e-3);
  EXPECT_NEAR(WindNoise(1.0, 0.0), 44.16, 6e-3);
  EXPECT_NEAR(ThermalNoise(1.0), -15.0, 6e-3);
  EXPECT_NEAR(AmbientNoise(1.0, 0.5, 0.0), 45.37, 6e-3);
  EXPECT_NEAR(AmbientNoise(10.0, 0.5, 0.0), 29.36, 6e-3);
  EXPECT_NEAR(AmbientNoise(10.0, 0.5, 5.0), 46.09, 6e-3);
  EXPECT_NEAR(AmbientNoise(25.0, 0.5, 5.0), 38.55, 6e-3);
}

TEST(Noise, AVehicleAtRestInAQuietSiteHearsTheAmbientNoiseInItsBand) {
  NoiseConfig noise;
  noise.site_db = -100.0;
  EXPECT_NEAR(NoiseModel(noise).BandLevelDb(25.0, 4.0, 0.0, false), 38.55 + 36.02, 0.01);
}

TEST(Noise, OwnNoiseGrowsWithSpeedAndPowersAdd) {
  NoiseConfig noise;
  EXPECT_NEAR(OwnNoise(noise, 10.0, 1.0), noise.own_db - 20.0, 1e-12);
  EXPECT_NEAR(OwnNoise(noise, 10.0, 2.0) - OwnNoise(noise, 10.0, 1.0), 60.0 * std::log10(2.0),
              1e-12);
  const NoiseModel model(noise);
  double last = model.BandLevelDb(25.0, 5.0, 0.0, false);
  for (double v = 0.5; v < 4.0; v += 0.5) {
    const double level = model.BandLevelDb(25.0, 5.0, v, false);
    EXPECT_GT(level, last);
    last = level;
  }
  // Two equal powers are 3 dB more than one.
  noise.site_db = AmbientNoise(25.0, noise.shipping, noise.wind_mps);
  EXPECT_NEAR(NoiseModel(noise).BandLevelDb(25.0, 1.0, 0.0, false), noise.site_db + 30.0 + 3.0103,
              1e-4);
}

TEST(Noise, ABurstRaisesWhatComesFromOutside) {
  const NoiseConfig noise;
  const NoiseModel model(noise);
  EXPECT_NEAR(model.BandLevelDb(25.0, 5.0, 0.0, true) - model.BandLevelDb(25.0, 5.0, 0.0, false),
              noise.burst_db, 1e-9);
  EXPECT_LT(model.BandLevelDb(25.0, 5.0, 3.0, true) - model.BandLevelDb(25.0, 5.0, 3.0, false),
            noise.burst_db - 5.0);
}

}  // namespace
}  // namespace stg::acoustics

#include "acoustic_channel/propagation/propagation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "acoustic_channel/modem/error_rate.hpp"
#include "acoustic_channel/propagation/boundaries.hpp"
#include "acoustic_channel/propagation/image_sources.hpp"
#include "acoustic_channel/water/absorption.hpp"
#include "acoustic_channel/water/noise.hpp"

namespace stg::acoustics {
namespace {

constexpr double kPi = 3.14159265358979323846;
using Point = Vec3<double>;

TEST(LinkBudget, SignalToNoiseOfThePage) {
  const Propagation water({}, {});
  const double noise_db = AmbientNoise(25.0, 0.5, 5.0) + RatioToDb(4000.0);
  const auto snr = [&](double d) {
    return 185.0 + water.At({0, 0, -20}, {d, 0, -20}, 25.0).gain_db - noise_db;
  };
  EXPECT_NEAR(snr(1000.0), 59.3, 0.05);
  EXPECT_NEAR(snr(2000.0), 48.7, 0.05);
}

TEST(LinkBudget, TravelTimeIsDistanceOverSoundSpeed) {
  WaterConfig config;
  config.temperature_c = 25.0;
  const Propagation water(config, {});
  const PathSum sum = water.At({0, 0, -20}, {300, 400, -20}, 25.0);
  EXPECT_NEAR(sum.distance_m, 500.0, 1e-12);
  EXPECT_NEAR(sum.travel_time_s, 500.0 / 1534.6, 2e-5);
  EXPECT_EQ(sum.rician_k, 10.0);
  EXPECT_EQ(sum.delay_spread_s, 0.0);
}

TEST(LinkBudget, BothWaysAreTheSameBitForBit) {
  PropagationConfig config;
  for (int paths : {1, 2, 7, 32}) {
    config.paths = paths;
    const Propagation water({}, config);
    const Point a{12.3, -45.6, -7.8}, b{901.2, 345.6, -78.9};
    const PathSum to = water.At(a, b, 25.0), back = water.At(b, a, 25.0);
    EXPECT_EQ(to.gain_db, back.gain_db);
    EXPECT_EQ(to.travel_time_s, back.travel_time_s);
    EXPECT_EQ(to.rician_k, back.rician_k);
    EXPECT_EQ(to.delay_spread_s, back.delay_spread_s);
  }
}

TEST(Multipath, WithoutBoundariesInReachItIsTheLinkBudget) {
  WaterConfig deep;
  deep.depth_m = 1e6;
  PropagationConfig config;
  config.spreading = 2.0;
  const Propagation straight(deep, config);
  config.paths = 16;
  config.wave_height_rms_m = 10.0;  // the surface scatters all sound
  const Propagation layer(deep, config);
  for (double r : {10.0, 300.0, 5000.0}) {
    const Point a{0, 0, -500}, b{r, 0, -700};
    EXPECT_NEAR(layer.At(a, b, 25.0).gain_db, straight.At(a, b, 25.0).gain_db, 1e-6);
    EXPECT_GT(layer.At(a, b, 25.0).rician_k, 1e5);
  }
}

TEST(Multipath, TwoPathsMakeLloydsMirror) {
  WaterConfig deep;
  deep.depth_m = 1e6;
  PropagationConfig config;
  config.spreading = 2.0;
  config.paths = 2;
  config.wave_height_rms_m = 0.0;
  const Propagation water(deep, config);
  const double khz = 1.0, z_s = 8.0, z_r = 11.0;
  const double k = 2.0 * kPi * khz * 1e3 * SoundSpeedProfile(deep).MeanSlowness(z_s, z_r);
  for (double r = 150.0; r < 4000.0; r *= 1.13) {
    const double absorbed = DbToRatio(ThorpAbsorption(khz) * r / 1000.0);
    const double p2 = std::norm(water.Tone({0, 0, -z_s}, {r, 0, -z_r}, khz));
    const double expected = 4.0 * std::pow(std::sin(k * z_s * z_r / r), 2);
    EXPECT_NEAR(p2 * r * r * absorbed, expected, 0.015 * 4.0) << r;
    if (r > 1000.0) {
      EXPECT_NEAR(p2 * r * r * absorbed / expected, 1.0, 0.001) << r;
    }
  }
}

/// Sum of 1/L^2 over all images between perfect boundaries: two combs of spacing 2H, each
/// pi / (2 H r) sinh(pi r / H) / (cosh(pi r / H) - cos(pi a / H)).
double CombSum(double r, double a, double H) {
  return kPi / (2.0 * H * r) * std::sinh(kPi * r / H) /
         (std::cosh(kPi * r / H) - std::cos(kPi * a / H));
}

TEST(Multipath, EnergyBetweenPerfectBoundariesIsTheClosedForm) {
  const double H = 50.0, z_a = 12.0, z_b = 31.0;
  for (double r : {5.0, 20.0, 50.0, 100.0, 400.0}) {
    double sum = 0.0;
    ForEachImage(r, z_a, z_b, H, 200000,
                 [&](const ImagePath& path) { sum += 1.0 / (path.length_m * path.length_m); });
    EXPECT_NEAR(sum / (CombSum(r, z_a + z_b, H) + CombSum(r, z_a - z_b, H)), 1.0, 3e-3) << r;
  }
}

TEST(Multipath, EnergyFallsAsInAWaveguideFarOutAndAsInOpenWaterBefore) {
  WaterConfig water;
  water.depth_m = 50.0;
  PropagationConfig config;
  config.spreading = 2.0;
  config.paths = 1024;
  config.wave_height_rms_m = 0.0;
  config.bottom_loss_db = 0.0;
  config.bottom_speed_ratio = 1.5;  // the bottom reflects totally up to 48 degrees
  const Propagation layer(water, config);
  const auto gain_db = [&](double r) {
    return layer.At({0, 0, -25}, {r, 0, -25}, 0.5).gain_db + ThorpAbsorption(0.5) * r / 1000.0;
  };
  for (double r : {250.0, 400.0, 600.0}) {
    EXPECT_NEAR(gain_db(r) - gain_db(2.0 * r), 10.0 * std::log10(2.0), 0.3) << r;
  }
  EXPECT_NEAR(gain_db(2.0) - gain_db(4.0), 20.0 * std::log10(2.0), 0.1);
}

TEST(Multipath, DirectShareAndDelaySpreadOfTwoPaths) {
  WaterConfig deep;
  deep.depth_m = 1e5;
  deep.sound_speed = WaterConfig::SoundSpeed::kProfile;  // 1500 m/s
  PropagationConfig config;
  config.spreading = 2.0;
  config.paths = 2;
  config.wave_height_rms_m = 0.0;
  const Propagation water(deep, config);
  const double r = 300.0, z = 200.0, khz = 0.4;
  const double image = 500.0;  // a triangle of 300, 400, 500
  const PathSum sum = water.At({0, 0, -z}, {r, 0, -z}, khz);
  const double ratio =
      std::pow(r / image, 2) * DbToRatio(-ThorpAbsorption(khz) * (image - r) / 1000.0);
  EXPECT_NEAR(sum.rician_k, 1.0 / ratio, 1e-9);
  const double share = ratio / (1.0 + ratio);
  EXPECT_NEAR(sum.delay_spread_s, (image - r) / 1500.0 * std::sqrt(share * (1.0 - share)), 1e-12);
}

TEST(Boundaries, SurfaceIsAPerfectMirrorWhenCalm) {
  EXPECT_EQ(SurfaceReflection(0.3, 100.0, 0.0), -1.0);
  EXPECT_NEAR(SurfaceReflection(0.5, 10.0, 0.1), -std::exp(-0.5), 1e-12);
}

TEST(Boundaries, RayleighsFormulaForABottom) {
  // At normal incidence only the ratio of impedances counts.
  EXPECT_NEAR(BottomReflection(1.0, 2.0, 1.25, 0.0).real(), 1.5 / 3.5, 1e-12);
  // Sand (1.9, 1.1) has a critical angle of acos(1/1.1) = 24.6 degrees. Reflection is total below
  // it and weaker above it.
  EXPECT_NEAR(std::abs(BottomReflection(std::sin(0.40), 1.9, 1.1, 0.0)), 1.0, 1e-12);
  EXPECT_LT(std::abs(BottomReflection(std::sin(0.47), 1.9, 1.1, 0.0)), 0.8);
  // The angle of intromission of a dense, slow bottom, where nothing is reflected.
  const double m = 1.5, n = 1.0 / 0.9;
  const double sin2 = (n * n - 1.0) / (m * m - 1.0);
  EXPECT_NEAR(std::abs(BottomReflection(std::sqrt(sin2), m, 0.9, 0.0)), 0.0, 1e-7);
  // Loss weakens total reflection. At grazing incidence everything is reflected with its sign
  // turned.
  EXPECT_LT(std::abs(BottomReflection(std::sin(0.3), 1.9, 1.1, 0.8)), 0.99);
  EXPECT_NEAR(BottomReflection(1e-9, 1.9, 1.1, 0.8).real(), -1.0, 1e-6);
}

TEST(Shadow, ABlockedLineLosesWhatTheSectionSays) {
  PropagationConfig config;
  const Propagation open({}, config);
  const Propagation walled(
      {}, config, [](const Point& a, const Point& b) { return (a.x < 50.0) == (b.x < 50.0); });
  const Point left{0, 0, -20}, right{100, 0, -20}, near{40, 0, -20};
  const PathSum shadowed = walled.At(left, right, 25.0);
  EXPECT_TRUE(shadowed.blocked);
  EXPECT_EQ(shadowed.rician_k, 0.0);
  EXPECT_NEAR(shadowed.gain_db, open.At(left, right, 25.0).gain_db - config.shadow_db, 1e-12);
  EXPECT_FALSE(walled.At(left, near, 25.0).blocked);
  EXPECT_EQ(walled.At(left, near, 25.0).gain_db, open.At(left, near, 25.0).gain_db);
}

}  // namespace
}  // namespace stg::acoustics

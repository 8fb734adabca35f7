#include "acoustic_channel/modem/error_rate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "acoustic_channel/propagation/fading.hpp"
#include "acoustic_channel/propagation/propagation.hpp"

namespace stg::acoustics {
namespace {

TEST(BitError, PublishedAndComputedValues) {
  EXPECT_NEAR(BpskBitError(DbToRatio(4.0)), 0.0125, 5e-5);
  EXPECT_NEAR(BpskBitError(DbToRatio(9.59)), 1e-5, 2e-7);
  EXPECT_NEAR(NoncoherentFskBitError(10.0), 3.37e-3, 5e-6);
  EXPECT_NEAR(RayleighBpskBitError(10.0), 0.02327, 5e-6);
  EXPECT_NEAR(RayleighNoncoherentFskBitError(10.0), 1.0 / 12.0, 1e-15);
  EXPECT_NEAR(RicianNoncoherentFskBitError(10.0, 10.0), 0.0151, 5e-5);
}

TEST(BitError, RiceLiesBetweenRayleighAndNoFading) {
  for (double gamma : {1.0, 10.0, 50.0}) {
    EXPECT_NEAR(RicianNoncoherentFskBitError(gamma, 0.0), RayleighNoncoherentFskBitError(gamma),
                1e-15);
    EXPECT_NEAR(RicianNoncoherentFskBitError(gamma, 1e9), NoncoherentFskBitError(gamma), 1e-8);
  }
}

TEST(PacketError, IsThatOfIndependentBits) {
  ErrorCurve fsk;
  const double success = std::pow(1.0 - NoncoherentFskBitError(DbToRatio(11.0)), 256);
  EXPECT_NEAR(std::exp(fsk.LogSuccess(11.0, 256)), success, 1e-12);
  fsk.processing_gain_db = 3.0;
  EXPECT_NEAR(std::exp(fsk.LogSuccess(8.0, 256)), success, 1e-12);
  ErrorCurve bpsk;
  bpsk.kind = ErrorCurve::Kind::kBpsk;
  EXPECT_NEAR(std::exp(bpsk.LogSuccess(7.0, 100)),
              std::pow(1.0 - BpskBitError(DbToRatio(7.0)), 100), 1e-12);
  ErrorCurve none;
  none.kind = ErrorCurve::Kind::kNone;
  EXPECT_EQ(none.LogSuccess(-100.0, 1e6), 0.0);
}

TEST(PacketError, StaysFiniteInEveryNoise) {
  for (auto kind : {ErrorCurve::Kind::kBpsk, ErrorCurve::Kind::kNoncoherentFsk}) {
    ErrorCurve curve;
    curve.kind = kind;
    EXPECT_NEAR(curve.LogSuccess(-400.0, 10), 10 * std::log(0.5), 1e-9);
    EXPECT_EQ(curve.LogSuccess(400.0, 10), 0.0);
  }
}

TEST(PacketError, HalfOfTheCodedFramesPassAtThePagesLevels) {
  const struct {
    int rate;
    double half_db, bits;
  } rows[] = {{1, -7.1, 512}, {3, -1.5, 2048}, {5, 3.9, 2048}};
  for (const auto& row : rows) {
    const ErrorCurve curve = CodedPskCurve(row.rate);
    EXPECT_NEAR(std::exp(curve.LogSuccess(row.half_db, row.bits)), 0.5, 1e-12);
    EXPECT_GT(std::exp(curve.LogSuccess(row.half_db + 1.5, row.bits)), 0.9);
    EXPECT_LT(std::exp(curve.LogSuccess(row.half_db - 1.5, row.bits)), 0.1);
    // Two frames: each of them passes with one half.
    EXPECT_NEAR(std::exp(curve.LogSuccess(row.half_db, 2 * row.bits)), 0.25, 1e-12);
  }
  EXPECT_THROW(CodedPskCurve(2), std::invalid_argument);
}

/// The table of the page, for NC-BFSK: 256 bits, R_b = B = 4 kHz, density 60, penalty 10 dB, K 10,
/// sigma 3 dB.
TEST(PacketError, SuccessOverDistanceOfTheWholeLink) {
  const struct {
    double level, distance, success;
  } rows[] = {{170, 500, .99}, {170, 1000, .72}, {170, 1500, .18}, {170, 2000, .01},
              {185, 500, 1.0}, {185, 1000, 1.0}, {185, 1500, 1.0}, {185, 2000, .95}};
  const PropagationConfig config;
  const Propagation water({}, config);
  const ErrorCurve curve;
  constexpr int kPackets = 40000;
  for (const auto& row : rows) {
    const PathSum path = water.At({0, 0, -20}, {row.distance, 0, -20}, 25.0);
    const double snr_db = row.level + path.gain_db - 60.0 - RatioToDb(4000.0) - 10.0;
    Shadowing shadowing(config, 2);
    shadowing.Reset(1, 0);
    double sum = 0.0;
    for (int i = 0; i < kPackets; ++i) {
      // The packets are so far apart that their slow fading is independent.
      const double fade_db = shadowing.LevelDb(0, 1, i * TimeNs{100'000'000'000}) +
                             RicianDb(path.rician_k, 1, 0, static_cast<std::uint32_t>(i), 0, 1);
      sum += std::exp(curve.LogSuccess(snr_db + fade_db, 256));
    }
    EXPECT_NEAR(sum / kPackets, row.success, 0.012) << row.level << " " << row.distance;
  }
}

}  // namespace
}  // namespace stg::acoustics

#include "acoustic_channel/link/link_estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "acoustic_channel/models/independent_model.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "channel_fixture.hpp"

namespace stg::acoustics {
namespace {

TEST(LinkEstimator, OfRangeIsEquation5WhateverTheAge) {
  ChannelConfig c;
  c.model = "range";
  c.range_m = 0.5;
  c.range.freshness_s = 3.0;
  const auto links = MakeLinkEstimator(c, 2);
  for (const double age : {0.0, 1.0, 100.0}) {
    EXPECT_EQ(links->Quality(0.0, age), 1.0);
    EXPECT_NEAR(links->Quality(0.2, age), 0.6, 1e-15);
    EXPECT_EQ(links->Quality(0.5, age), 0.0);
    EXPECT_EQ(links->Quality(7.0, age), 0.0);
  }
  EXPECT_EQ(links->freshness_s(), 3.0);
}

TEST(LinkEstimator, OfExtendedIsEquation6) {
  ChannelConfig c;
  c.model = "extended";
  c.extended.attenuation_per_m = 0.5;
  c.extended.loss_probability = 0.1;
  c.extended.loss_distance_m = 2.0;
  c.extended.freshness_s = 2.0;
  const auto links = MakeLinkEstimator(c, 2);
  for (const double d : {0.0, 0.3, 1.0, 3.0}) {
    for (const double age : {0.0, 0.4, 5.0}) {
      const double q = 0.9 * std::exp(-d * d / 4.0) * std::exp(-0.5 * d) * std::exp(-age / 2.0);
      EXPECT_NEAR(links->Quality(d, age), q, 1e-14) << d << " " << age;
    }
  }
  EXPECT_EQ(links->freshness_s(), 2.0);
}

TEST(LinkEstimator, PacksAndScalarsAgreeBitForBit) {
  for (const char* model : {"range", "extended", "physical"}) {
    ChannelConfig c;
    c.model = model;
    const auto links = MakeLinkEstimator(c, 2);
    for (double d = 0.0; d < 4.0; d += 0.037) {
      const double learnt = 1.0 / (1.0 + d);
      const Pack quality = links->Quality(Pack(d), Pack(0.2 * d), Pack(learnt));
      for (int lane = 0; lane < kLanes; ++lane) {
        EXPECT_EQ(Lane(quality, lane), links->Quality(d, 0.2 * d, learnt));
      }
    }
  }
}

TEST(LinkEstimator, OfPhysicalLearnsFromGapsAndLevels) {
  ChannelConfig c;
  c.model = "physical";
  c.physical.modem.freshness_s = 20.0;
  const auto links = MakeLinkEstimator(c, 3);
  const std::uint8_t bytes[32] = {};
  const auto hear = [&](int lane, std::uint32_t sequence, double sinr_db) {
    Reception r;
    r.source = 1;
    r.sequence = sequence;
    r.sinr_db = sinr_db;
    r.payload = {bytes, sizeof(bytes)};
    links->Learn(lane, r);
  };
  EXPECT_EQ(links->Learnt(1)[0], 1.0);
  hear(0, 5, 40.0);
  EXPECT_NEAR(links->Learnt(1)[0], 1.0, 1e-9) << "what was before it came is unknown";
  hear(0, 8, 40.0);  // two packets are missing
  EXPECT_NEAR(links->Learnt(1)[0], 1.0 - 0.2 * 0.0 - (1.0 - 0.64) * 0.8, 1e-9);
  for (std::uint32_t k = 9; k < 60; ++k) hear(0, k, 40.0);
  EXPECT_NEAR(links->Learnt(1)[0], 1.0, 1e-4);
  for (std::uint32_t k = 60; k < 400; k += 2) hear(0, k, 40.0);
  EXPECT_NEAR(links->Learnt(1)[0], 0.5, 0.1) << "every other one is lost";
  hear(kLanes - 1, 0, -5.0);
  EXPECT_LT(links->Learnt(1)[kLanes - 1], 0.01) << "hardly above what is lost";
  links->Reset(1);
  hear(1, 0, 0.0);  // this modem measures neither ratio nor noise
  EXPECT_EQ(links->Learnt(1)[1], 1.0);
  EXPECT_EQ(links->Learnt(2)[0], 1.0);
  EXPECT_NEAR(links->Quality(777.0, 10.0, 0.6), 0.6 * std::exp(-0.5), 1e-12);
  EXPECT_EQ(links->freshness_s(), 20.0);
  links->Reset(0);
  EXPECT_EQ(links->Learnt(1)[0], 1.0);
}

TEST(LinkEstimator, MeansWhatTheChannelMeans) {
  for (const char* model : {"range", "extended"}) {
    NetworkConfig s = LosslessNetwork(2);
    s.channel.model = model;
    s.channel.range_m = 1.0;
    const auto channel = MakeChannel(s.channel, s.run);
    const auto links = MakeLinkEstimator(s.channel, s.run.agents);
    channel->Reset(1, 0);
    Transmission packet = From(0, 7 * kDt);
    packet.generation = 5 * kDt;
    StepAtRest(channel.get(), 7 * kDt, 7, {{}, {0.6, 0.0, 0.0}}, {packet});
    std::vector<Reception> got;
    channel->Deliver(1, 8 * kDt, &got);
    ASSERT_EQ(got.size(), 1u);
    EXPECT_NEAR(got[0].link_quality,
                links->Quality(0.6, Seconds(got[0].arrival - got[0].generation)), 1e-9);
    const LinkStatistics link = channel->Link(0, 1, 9 * kDt);
    EXPECT_EQ(link.quality, links->Quality(link.distance_m, link.age_s)) << model;
  }
}

/// Half of all packets arrive, at any distance. The quality falls with the distance.
struct Coin {
  template <class T>
  T DelayS(const T& /*d*/) const {
    return T(0.0);
  }
  template <class T>
  LinkValues<T> At(const T& d, const T& /*age_s*/) const {
    return {T(0.5), T(1.0) / (T(1.0) + d)};
  }
  bool Reaches(double /*d*/) const { return true; }
  bool ages() const { return false; }
  double freshness_s() const { return 4.0; }
};

TEST(PropagationModel, OneFromOutsideIsARegisteredName) {
  if (!PropagationModels().Has("coin")) {  // the test may run repeatedly
    PropagationModels().Add("coin", [](const ChannelConfig&) {
      return std::make_unique<IndependentModel<Coin>>(Coin());
    });
  }
  NetworkConfig s = LosslessNetwork(2);
  s.channel.model = "coin";
  s.channel.extended.loss_distance_m = 1e6;  // the AUVs are in range, and this has no effect
  EXPECT_FALSE(config::FindViolation(s));
  EXPECT_EQ(MakeLinkEstimator(s.channel, s.run.agents)->Quality(3.0, 0.0), 0.25);
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  const std::vector<Vec3<double>> p = {{}, {1e4, 0, 0}};
  for (std::uint32_t k = 0; k < 1000; ++k) {
    StepAtRest(channel.get(), k * kDt, k, p, {From(0, k * kDt)});
    DeliverAll(channel.get(), (k + 1) * kDt);
  }
  EXPECT_NEAR(static_cast<double>(channel->totals().delivered), 500.0, 4.5 * std::sqrt(250.0));
}

TEST(PropagationModel, AnUnknownOneIsRefusedWithTheList) {
  NetworkConfig s = LosslessNetwork(2);
  s.channel.model = "telepathy";
  for (const bool channel : {false, true}) {
    try {
      if (channel) {
        MakeChannel(s.channel, s.run);
      } else {
        MakeLinkEstimator(s.channel, s.run.agents);
      }
      FAIL();
    } catch (const UserError& error) {
      EXPECT_EQ(
          std::string(error.what())
              .find("unknown propagation model 'telepathy', expected one of range | extended"),
          0u)
          << error.what();
    }
  }
}

TEST(PropagationModel, AnUnknownOneIsRefusedWhenAFileIsLoaded) {
  const NetworkConfig good;
  std::string text = config::ToYaml(good);
  EXPECT_EQ(config::LoadText<NetworkConfig>(text, "net.yaml").channel.model, "extended");
  const auto at = text.find("extended");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string("extended").size(), "telepathy");
  try {
    config::LoadText<NetworkConfig>(text, "net.yaml");
    FAIL();
  } catch (const UserError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("channel.model: expected one of range | extended"), std::string::npos)
        << what;
    EXPECT_NE(what.find("net.yaml:"), std::string::npos);
    EXPECT_NE(what.find("found 'telepathy'"), std::string::npos);
  }
}

}  // namespace
}  // namespace stg::acoustics

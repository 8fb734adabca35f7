// AUVs measure the range to a target with pings of their modems: the cost of a ping, the ways in
// which it fails, and whole flights.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "acoustic_channel/modem/modem_profile.hpp"
#include "acoustic_channel/water/sound_speed.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_agent/stations/station_channel.hpp"
#include "stg_env/env/evaluation.hpp"

namespace stg::env {
namespace {

using acoustics::Reception;

constexpr double kDepth_m = 40.0;
constexpr TimeNs kSecond = 1'000'000'000;

/// Two AUVs and a target at rest. The ranges have no error of their own.
class PingTest : public ::testing::Test {
 protected:
  void Make(double target_m, const std::vector<std::string>& more = {}) {
    scenario_ =
        Shipped("field", "ping_ranging",
                {"agents=2", "sensing.range.range_std_m=1e-9", "sensing.range.range_std_share=0.0",
                 "sensing.range.probability_at_range=1.0", "sensing.detection_probability=1.0"});
    config::Override(&scenario_, more);
    channel_ = agent::MakeStationChannel(scenario_.model(), scenario_.channel,
                                         scenario_.world.sensing, {});
    ASSERT_EQ(channel_->nodes(), 2);
    ASSERT_EQ(channel_->bodies(), scenario_.world.sensing.pings() ? 3 : 2);
    p_W_ = {{0.0, 0.0, -kDepth_m}, {50.0, 0.0, -kDepth_m}, {target_m, 0.0, -kDepth_m}};
    p_W_.resize(static_cast<std::size_t>(channel_->bodies()));
    modem_ = acoustics::MakeProfiles(scenario_.channel.physical.modem, 1).front();
    sound_mps_ = acoustics::SoundSpeedProfile(scenario_.channel.physical.water).At(kDepth_m);
    channel_->Reset(7, 0);
  }

  /// Steps the channel until a time. In each step AUV `talker` offers a packet (-1: none). Returns
  /// the answers to pings that each of the two AUVs got.
  std::vector<std::vector<Reception>> Run(double seconds, int talker = -1) {
    std::vector<std::vector<Reception>> answers(2);
    const std::vector<Vec3<double>> still(p_W_.size());
    const std::vector<std::uint8_t> bytes(32, 1);
    std::vector<Reception> received;
    for (std::uint32_t step = 0; Seconds(step * kSecond) < seconds; ++step) {
      const TimeNs t = step * kSecond;
      std::vector<acoustics::Transmission> offered;
      if (talker >= 0) {
        acoustics::Transmission& packet = offered.emplace_back();
        packet.source = talker;
        packet.stamp = packet.generation = t;
        packet.payload = acoustics::ViewOf(bytes);
      }
      channel_->Step(t, step, p_W_, still, offered);
      for (int i = 0; i < 2; ++i) {
        received.clear();
        channel_->Deliver(i, t + kSecond, &received);
        for (const Reception& r : received) {
          if (r.payload.size == 0) answers[static_cast<std::size_t>(i)].push_back(r);
        }
      }
    }
    return answers;
  }

  Scenario scenario_;
  std::unique_ptr<acoustics::Channel> channel_;
  acoustics::ModemProfile modem_;
  double sound_mps_ = 0.0;
  std::vector<Vec3<double>> p_W_;
};

TEST_F(PingTest, TheAnswerComesAfterTheWayThereAndBackInTheOwnSlot) {
  constexpr double kRange_m = 450.0;
  Make(kRange_m);
  const auto answers = Run(30.0);
  ASSERT_EQ(answers[0].size(), 1U);
  ASSERT_EQ(answers[1].size(), 1U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Reception& r = answers[i].front();
    const double way_s = (kRange_m - p_W_[i].x) / sound_mps_;
    const double slot_s = 1.25 * static_cast<double>(i);
    EXPECT_EQ(r.source, 2);
    EXPECT_DOUBLE_EQ(Seconds(r.transmit), slot_s);
    EXPECT_NEAR(r.travel_time_s, way_s, 1e-8);
    EXPECT_NEAR(Seconds(r.arrival),
                slot_s + 2.0 * (modem_.airtime_s(1) + way_s) + modem_.turnaround_s, 1e-8);
    EXPECT_NEAR(Seconds(r.generation),
                slot_s + 0.5 * (modem_.airtime_s(1) + way_s + modem_.turnaround_s), 1e-8);
  }
  EXPECT_EQ(channel_->pings().sent, 2U);
  EXPECT_EQ(channel_->pings().answered, 2U);
}

TEST_F(PingTest, EachCostsItsSoundAndTheHearingOfTheAnswers) {
  Make(450.0);
  constexpr double kTime_s = 300.0;
  const auto answers = Run(kTime_s);
  const double pings = kTime_s / 30.0;
  ASSERT_EQ(answers[0].size(), static_cast<std::size_t>(pings));
  const double airtime_s = modem_.airtime_s(1);
  EXPECT_NEAR(channel_->SentS(0, 300 * kSecond), pings * airtime_s, 1e-6);
  // It hears the answers to itself, and the request and the answer of the other AUV.
  const double heard_s = 3.0 * pings * airtime_s;
  const double sent_s = pings * airtime_s;
  EXPECT_NEAR(channel_->EnergyJ(0, 300 * kSecond),
              modem_.transmit_w * sent_s + modem_.receive_w * heard_s +
                  modem_.idle_w * (kTime_s - sent_s - heard_s),
              1e-3);
}

TEST_F(PingTest, ItTakesTheTurnOfAPacket) {
  // AUV 0 has the twelve slots at 0, 2.5, ... 27.5 s.
  Make(450.0);
  Run(30.0, 0);
  EXPECT_EQ(channel_->totals().delivered, 11U);
  Make(450.0, {"sensing.ranging=free"});
  Run(30.0, 0);
  EXPECT_EQ(channel_->totals().delivered, 12U);
}

TEST_F(PingTest, ACollisionKillsTheRange) {
  const std::vector<std::string> at_once{"channel.access=aloha", "channel.contention.rest_s=25.0"};
  // The request of the nearer AUV is still at the target when the other one's comes.
  Make(450.0, at_once);
  EXPECT_TRUE(Run(2.0)[0].empty());
  EXPECT_EQ(channel_->pings().sent, 2U);
  Make(450.0, at_once);
  p_W_[1] = {5000.0, 0.0, -kDepth_m};
  EXPECT_EQ(Run(2.0)[0].size(), 1U);
}

TEST_F(PingTest, NothingComesFromOutOfReach) {
  Make(650.5);
  const auto answers = Run(30.0);
  EXPECT_TRUE(answers[0].empty());  // 650.5 m
  EXPECT_TRUE(answers[1].empty());  // 600.5 m
  EXPECT_EQ(channel_->pings().sent, 2U);
  EXPECT_EQ(channel_->pings().answered, 0U);
  EXPECT_NEAR(channel_->SentS(0, 30 * kSecond), modem_.airtime_s(1), 1e-9);
  // No answer comes either where the noise is too loud.
  Make(450.0, {"channel.physical.noise.site_db=140"});
  EXPECT_TRUE(Run(30.0)[0].empty());
}

TEST_F(PingTest, TheSensorsChanceAndErrorAreThoseOfTheTransponder) {
  Make(300.0, {"sensing.detection_probability=0.6", "sensing.range.range_std_m=2.0",
               "sensing.range.range_std_share=0.01", "sensing.period_s=5.0"});
  const auto answers = Run(5000.0)[0];
  constexpr double kAsked = 1000.0, kStd_m = 5.0;
  EXPECT_NEAR(static_cast<double>(answers.size()), 0.6 * kAsked, 3.0 * std::sqrt(0.24 * kAsked));
  double square = 0.0;
  for (const Reception& r : answers) {
    const double error = r.travel_time_s * sound_mps_ - 300.0;
    square += error * error;
  }
  EXPECT_NEAR(square / static_cast<double>(answers.size()) / (kStd_m * kStd_m), 1.0, 0.2);
}

// The times of a request and of its answer each have the modems' timing error.
TEST_F(PingTest, TheModemsTimingCountsTwiceAndByHalf) {
  constexpr double kTiming_s = 0.001, kPings = 800.0;
  Make(300.0, {"channel.physical.modem.timing_std_s=0.001", "sensing.period_s=7.0"});
  const auto answers = Run(7.0 * kPings)[0];
  ASSERT_EQ(answers.size(), static_cast<std::size_t>(kPings));
  double square = 0.0;
  for (const Reception& r : answers) {
    const double error_s = r.travel_time_s - 300.0 / sound_mps_;
    square += error_s * error_s;
  }
  EXPECT_NEAR(square / kPings / (0.5 * kTiming_s * kTiming_s), 1.0, 0.2);
}

TEST(PingFlight, TheFieldIsFlownOnPings) {
  const auto fly = [](const std::vector<std::string>& keys) {
    Scenario s = Short(Shipped("field", "ping_ranging", keys), 900);
    s.run.time.tail_steps = 300;
    const auto flights = Evaluate(EnvFactory(s), agent::MakeDecider("encircle", s.model()),
                                  {8, 500, kMixBlock}, nullptr);
    const task::MetricSummary m = task::Summarise(flights);
    std::printf("band %.3f, own error %.1f m, NEES %.2f, modem %.0f J, pings %.1f, lost %.3f\n",
                m.Mean("band_share"), m.Mean("own_rmse"), m.Mean("nees"), m.Mean("modem_energy"),
                m.Mean("pings"), m.Mean("ping_loss"));
    return m;
  };
  const task::MetricSummary ping = fly({});
  const task::MetricSummary free = fly({"sensing.ranging=free"});
  EXPECT_NEAR(ping.Mean("pings"), 30.0, 0.5);
  EXPECT_GT(ping.Mean("ping_loss"), 0.05);  // the chance is 0.9 close by, and lower far away
  EXPECT_LT(ping.Mean("ping_loss"), 0.5);
  EXPECT_GT(ping.Mean("band_share"), free.Mean("band_share") - 0.05);
  EXPECT_LT(ping.Mean("nees"), 5.0);
  EXPECT_EQ(free.Mean("pings"), 0.0);
  // A slot holds a packet or a ping, so pings leave less room for packets.
  EXPECT_LT(ping.Mean("packets"), 0.9 * free.Mean("packets"));
}

TEST(PingFlight, WhatDoesNotGoTogetherIsRefusedByName) {
  const auto error = [](const std::vector<std::string>& keys) {
    try {
      Shipped("field", "ping_ranging", keys);
    } catch (const UserError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(error({"sensing.sensor=position", "track.filter=kalman"}).find("sensing.sensor"),
            std::string::npos);
  EXPECT_NE(error({"sensing.range.outlier_probability=0.1"}).find("outlier_probability"),
            std::string::npos);
  EXPECT_NE(error({"channel.model=range"}).find("only modems can ping"), std::string::npos);
  // A round of slots takes 5 s. Each turn of an AUV would be a ping, and no packet would leave.
  EXPECT_NE(error({"sensing.period_s=5.0"}).find("sensing.period_s"), std::string::npos);
  EXPECT_EQ(error({"sensing.period_s=7.0"}), "");
}

}  // namespace
}  // namespace stg::env

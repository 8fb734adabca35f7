#include <gtest/gtest.h>

#include <cmath>

#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/link/link_statistics.hpp"

namespace stg::acoustics {
namespace {

constexpr TimeNs kSecond = 1'000'000'000;

TEST(Age, HandComputedCourseWithALatePacket) {
  LinkTable table(2);
  table.Reset(0);
  table.Deliver(0, 1, 1 * kSecond, 1 * kSecond, 2 * kSecond);  // age 2 -> 1
  table.Deliver(0, 1, kSecond / 2, kSecond / 2, 3 * kSecond);  // late: age stays 2
  table.Deliver(0, 1, 4 * kSecond, 4 * kSecond, 5 * kSecond);  // age 4 -> 1
  const LinkStatistics s = table.At(0, 1, 6 * kSecond);
  EXPECT_DOUBLE_EQ(s.age_s, 2.0);
  // Trapezoids: 0..2 from 0 to 2; 2..5 from 1 to 4; 5..6 from 1 to 2.
  EXPECT_DOUBLE_EQ(s.average_age_s, (2.0 + 7.5 + 1.5) / 6.0);
  EXPECT_DOUBLE_EQ(s.peak_age_s, (2.0 + 4.0) / 2.0);
  EXPECT_DOUBLE_EQ(s.max_age_s, 4.0);
  EXPECT_DOUBLE_EQ(s.mean_delay_s, (1.0 + 2.5 + 1.0) / 3.0);
  EXPECT_EQ(s.delivered, 3u);
}

TEST(Age, BeforeTheFirstDeliveryItCountsFromTheStartOfTheEpisode) {
  LinkTable table(2);
  table.Reset(10 * kSecond);
  const LinkStatistics s = table.At(0, 1, 14 * kSecond);
  EXPECT_DOUBLE_EQ(s.age_s, 4.0);
  EXPECT_DOUBLE_EQ(s.average_age_s, 2.0);
  EXPECT_DOUBLE_EQ(s.max_age_s, 4.0);
  EXPECT_EQ(s.peak_age_s, 0.0);
  EXPECT_EQ(table.At(0, 1, 10 * kSecond).average_age_s, 0.0);
}

TEST(Age, ARepeatedPacketCountsAsDeliveredButNotAsFresh) {
  LinkTable table(2);
  table.Reset(0);
  table.Deliver(0, 1, kSecond, kSecond, 2 * kSecond);
  const LinkStatistics before = table.At(0, 1, 4 * kSecond);
  table.Deliver(0, 1, kSecond, kSecond, 7 * kSecond / 2);
  const LinkStatistics after = table.At(0, 1, 4 * kSecond);
  EXPECT_EQ(after.delivered, 2u);
  EXPECT_EQ(after.age_s, before.age_s);
  EXPECT_DOUBLE_EQ(after.average_age_s, before.average_age_s);
  EXPECT_EQ(after.peak_age_s, before.peak_age_s);
}

TEST(Age, AskingDoesNotChangeTheAnswer) {
  LinkTable table(2), asked(2);
  for (LinkTable* t : {&table, &asked}) {
    t->Reset(0);
    t->Deliver(0, 1, kSecond, kSecond, 2 * kSecond);
    for (TimeNs now = 2 * kSecond; t == &asked && now < 9 * kSecond; now += kSecond / 7) {
      t->At(0, 1, now);
    }
    t->Deliver(0, 1, 8 * kSecond, 8 * kSecond, 9 * kSecond);
  }
  EXPECT_EQ(table.At(0, 1, 9 * kSecond).average_age_s, asked.At(0, 1, 9 * kSecond).average_age_s);
}

/// Periodic transmission with frame T, independent loss p, delay D, and packets that are made when
/// they leave: average age D + T (1 + p) / (2 (1 - p)), peak age D + T / (1 - p).
void CheckPeriodic(double p, double delay_s, int frame_steps) {
  constexpr TimeNs kDt = kSecond / 10;
  constexpr int kFrames = 100000;
  NetworkConfig s;
  s.run.agents = 2;
  s.channel.model = "extended";
  s.channel.periodic.transmit_period_s = 0.1;
  s.channel.extended.loss_probability = p;
  s.channel.extended.loss_distance_m = 1e12;
  s.channel.extended.sound_speed_mps = 1.0 / delay_s;  // the AUVs are 1 m apart
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(17, 3);
  const std::vector<Vec3<double>> p_W{{0, 0, 0}, {0.6, 0.8, 0}}, at_rest(2);
  const std::uint8_t byte = 7;
  std::vector<Reception> got;
  TimeNs t = 0;
  for (int k = 0; k < kFrames * frame_steps; ++k, t += kDt) {
    std::vector<Transmission> sent;
    if (k % frame_steps == 0) {
      sent.resize(1);
      sent[0].stamp = sent[0].generation = t;
      sent[0].payload = {&byte, 1};
    }
    channel->Step(t, static_cast<std::uint32_t>(k), p_W, at_rest, sent);
    got.clear();
    channel->Deliver(1, t + kDt, &got);
  }
  const LinkStatistics link = channel->Link(0, 1, t);
  const double T = 0.1 * frame_steps;
  // The times between deliveries are geometric. The tolerance is five standard errors of their
  // mean, and of the ratio of their second to their first moment, and some more for the first
  // frames.
  const double error = T * (std::sqrt(p) / (1 - p)) / std::sqrt(kFrames * (1 - p));
  EXPECT_NEAR(link.peak_age_s, delay_s + T / (1 - p), 5 * error + 20 * T / kFrames);
  EXPECT_NEAR(link.average_age_s, delay_s + T * (1 + p) / (2 * (1 - p)),
              15 * error / (1 - p) + 20 * T / kFrames);
  EXPECT_NEAR(link.mean_delay_s, delay_s, 1e-9);
}

TEST(Age, PeriodicTransmissionWithoutLossMatchesTheClosedForm) { CheckPeriodic(0.0, 0.13, 5); }
TEST(Age, PeriodicTransmissionWithLossMatchesTheClosedForm) { CheckPeriodic(0.3, 0.13, 5); }
TEST(Age, HeavyLossMatchesTheClosedForm) { CheckPeriodic(0.7, 0.02, 5); }
TEST(Age, SeveralPacketsUnderWayMatchTheClosedForm) { CheckPeriodic(0.3, 1.27, 5); }

}  // namespace
}  // namespace stg::acoustics

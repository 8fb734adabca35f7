#include <map>
#include <tuple>

#include "auv_common/error.hpp"
#include "channel_fixture.hpp"
#include "network/network_fixture.hpp"

/// What every channel model tells an observer, and what happens when nodes come and go.
namespace stg::acoustics {
namespace {

NetworkConfig Swarm(const std::string& model) {
  NetworkConfig s;
  s.run.agents = 4;
  s.channel.model = model;
  s.channel.extended.loss_probability = 0.3;
  s.channel.range_m = 2.5;
  s.channel.extended.max_range_m = 2.5;
  if (model == "physical") {
    s.channel.access = "aloha";
    s.channel.physical.modem.profile = "evologics_s2c";
    s.channel.contention.rest_s = 1.0;
  }
  return s;
}

std::vector<Vec3<double>> Line(int nodes) {
  std::vector<Vec3<double>> p;
  for (int i = 0; i < nodes; ++i) p.push_back({1.0 * i, 0.0, -5.0});
  return p;
}

TEST(Observer, IsToldOfEveryPacketOnceByEveryModel) {
  for (const char* model : {"range", "extended", "physical"}) {
    const NetworkConfig s = Swarm(model);
    const auto channel = MakeChannel(s.channel, s.run);
    Log log;
    channel->Reset(3, 0);
    channel->Observe(&log);
    std::vector<Reception> got;
    constexpr std::uint32_t kSteps = 200;
    for (std::uint32_t k = 0; k < kSteps + 100; ++k) {
      std::vector<Transmission> offered;
      for (int i = 0; k < kSteps && i < 4; ++i) {
        Transmission packet = From(i, k * kDt);
        packet.tag = 4 * k + static_cast<std::uint32_t>(i);
        offered.push_back(packet);
      }
      StepAtRest(channel.get(), k * kDt, k, Line(4), offered);
      for (int j = 0; j < 4; ++j) channel->Deliver(j, (k + 1) * kDt, &got);
    }
    std::map<std::uint32_t, int> ends, fates;
    for (const Log::Discarded& d : log.discarded) ++ends[d.packet.tag];
    for (const PacketInfo& p : log.sent) ++ends[p.tag];
    std::uint64_t delivered = 0;
    for (const Log::Fate& f : log.fates) {
      ++fates[f.packet.tag];
      if (f.fate.reason != DropReason::kNone) continue;
      ++delivered;
      EXPECT_GE(f.fate.arrival, f.fate.begin);
      EXPECT_NEAR(f.fate.distance_m, std::abs(f.packet.source - f.fate.receiver), 1e-9);
    }
    EXPECT_EQ(log.queued.size(), 4 * kSteps) << model;
    EXPECT_GE(ends.size(), 4 * kSteps - 4) << model << ": but for those that still wait";
    for (const auto& [tag, times] : ends) EXPECT_EQ(times, 1) << model << " " << tag;
    EXPECT_EQ(fates.size(), log.sent.size()) << model;
    for (const auto& [tag, times] : fates) EXPECT_EQ(times, 3) << model << " " << tag;
    EXPECT_EQ(delivered, got.size()) << model;
    EXPECT_EQ(delivered, channel->totals().delivered) << model;
    EXPECT_GT(delivered, 10u) << model;
    EXPECT_EQ(channel->totals().dropped, log.fates.size() - delivered + 3 * log.discarded.size())
        << model;
    for (std::size_t k = 0; k < got.size(); ++k) EXPECT_LT(got[k].tag, 4 * kSteps);
  }
}

TEST(Observer, ChangesNothing) {
  for (const char* model : {"range", "extended", "physical"}) {
    const NetworkConfig s = Swarm(model);
    std::vector<Reception> got[2];
    for (const bool watched : {false, true}) {
      const auto channel = MakeChannel(s.channel, s.run);
      Log log;
      channel->Reset(3, 0);
      if (watched) channel->Observe(&log);
      for (std::uint32_t k = 0; k < 100; ++k) {
        StepAtRest(channel.get(), k * kDt, k, Line(4), {From(0, k * kDt), From(2, k * kDt)});
        for (int j = 0; j < 4; ++j) channel->Deliver(j, (k + 1) * kDt, &got[watched]);
      }
    }
    ASSERT_EQ(got[0].size(), got[1].size()) << model;
    ASSERT_GT(got[0].size(), 0u) << model;
    for (std::size_t k = 0; k < got[0].size(); ++k) {
      EXPECT_EQ(got[0][k].arrival, got[1][k].arrival) << model;
      EXPECT_EQ(got[0][k].sinr_db, got[1][k].sinr_db) << model;
    }
  }
}

TEST(ChannelPresence, AnAbsentNodeNeitherSendsNorHearsInAnyModel) {
  for (const char* model : {"range", "extended", "physical"}) {
    NetworkConfig s = Swarm(model);
    s.channel.extended.loss_probability = 0.0;
    s.channel.extended.loss_distance_m = 1e9;
    s.channel.periodic.transmit_period_s = 0.1;
    s.channel.contention.rest_s = 0.0;
    const auto channel = MakeChannel(s.channel, s.run);
    Log log;
    channel->Reset(3, 0);
    channel->Observe(&log);
    std::vector<Reception> got;
    const double nan = std::nan("");
    for (std::uint32_t k = 0; k < 60; ++k) {
      const bool there = k < 20 || k >= 40;
      auto p = Line(4);
      if (!there) p[1] = {nan, nan, nan};  // the place of an absent node is unknown
      channel->SetPresent(1, there);
      std::vector<Transmission> offered;
      if (k % 10 == 5) offered.push_back(From(0, k * kDt));
      StepAtRest(channel.get(), k * kDt, k, p, offered);
      for (int j = 0; j < 4; ++j) channel->Deliver(j, (k + 1) * kDt, &got);
    }
    int heard = 0, left = 0;
    for (const Reception& r : got) heard += r.receiver == 1 ? 1 : 0;
    for (const Log::Fate& f : log.fates) {
      if (f.fate.receiver == 1 && f.fate.reason == DropReason::kLeft) ++left;
    }
    EXPECT_EQ(heard, 4) << model;
    EXPECT_EQ(left, 2) << model;
  }
}

TEST(ChannelPing, IsOfModelsWithModems) {
  for (const char* model : {"range", "extended", "physical"}) {
    const NetworkConfig s = Swarm(model);
    const auto channel = MakeChannel(s.channel, s.run);
    channel->Reset(1, 0);
    if (channel->continuous()) {
      EXPECT_THROW(channel->Ping(0, 4, 0, kDt, 0), UserError);
      EXPECT_THROW(channel->Ping(2, 2, 0, kDt, 0), UserError);
      Log log;
      channel->Observe(&log);
      StepAtRest(channel.get(), 0, 0, Line(4), {});
      channel->Ping(0, 2, 0, 100 * kDt, 9);
      std::vector<Reception> got;
      channel->Deliver(0, 50 * kDt, &got);
      ASSERT_EQ(log.pings.size(), 1u);
      EXPECT_TRUE(log.pings[0].answered);
      EXPECT_NEAR(log.pings[0].range_m, 2.0, 1e-3);
    } else {
      EXPECT_THROW(channel->Ping(0, 1, 0, kDt, 0), UserError);
    }
  }
}

TEST(PhysicalChannel, TakesPacketsOfAnyTimeSinceTheLastStep) {
  NetworkConfig s = Swarm("physical");
  s.channel.contention.rest_s = 0.0;
  const auto channel = MakeChannel(s.channel, s.run);
  ASSERT_TRUE(channel->continuous());
  channel->Reset(1, 0);
  std::vector<Reception> got;
  StepAtRest(channel.get(), 0, 0, Line(4), {});
  channel->Deliver(1, 0, &got);
  const TimeNs offered = 7 * kDt / 3;
  StepAtRest(channel.get(), 10 * kDt, 1, Line(4), {From(0, offered)});
  channel->Deliver(1, 10 * kDt, &got);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].transmit, offered);
  EXPECT_NEAR(Seconds(got[0].arrival - offered), 0.1515 + 4 * 0.011 + got[0].travel_time_s, 2e-9);
}

}  // namespace
}  // namespace stg::acoustics

#include "acoustic_channel/channel/channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "acoustic_channel/models/extended.hpp"
#include "channel_fixture.hpp"

namespace stg::acoustics {
namespace {

NetworkConfig ExtendedScenario(int agents) {
  NetworkConfig s = LosslessNetwork(agents);
  s.channel.extended.loss_probability = 0.1;
  s.channel.extended.loss_distance_m = 2.0;
  return s;
}

std::vector<Vec3<double>> RandomPositions(int agents, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::vector<Vec3<double>> p;
  for (int i = 0; i < agents; ++i) {
    const double x = u(engine), y = u(engine), z = u(engine);
    p.push_back({x, y, z});
  }
  return p;
}

/// Everything that a run delivered.
struct Record {
  int source, destination;
  std::uint32_t sequence;
  TimeNs arrival;
  bool operator==(const Record& o) const {
    return source == o.source && destination == o.destination && sequence == o.sequence &&
           arrival == o.arrival;
  }
};

/// Runs `steps` steps. Every AUV with a true entry in `sends` transmits, in the order that
/// `shuffle` gives.
std::vector<Record> Play(const NetworkConfig& scenario, std::uint64_t seed, std::uint32_t episode,
                         int steps, const std::vector<bool>& sends, std::uint64_t shuffle,
                         Channel* reuse = nullptr, double spread = 1.0) {
  std::unique_ptr<Channel> own;
  if (reuse == nullptr) own = MakeChannel(scenario.channel, scenario.run);
  Channel& channel = reuse ? *reuse : *own;
  channel.Reset(seed, episode);
  std::vector<Vec3<double>> p = RandomPositions(scenario.run.agents, 5);
  for (auto& v : p) v = v * spread;
  std::mt19937_64 engine(shuffle);
  std::vector<Record> records;
  for (int k = 0; k < steps; ++k) {
    const TimeNs t = k * kDt;
    std::vector<Transmission> sent;
    for (int i = 0; i < scenario.run.agents; ++i) {
      if (sends[static_cast<std::size_t>(i)]) {
        sent.push_back(From(i, t));
      }
    }
    if (shuffle != 0) std::shuffle(sent.begin(), sent.end(), engine);
    StepAtRest(&channel, t, static_cast<std::uint32_t>(k), p, sent);
    for (const Reception& r : DeliverAll(&channel, t + kDt)) {
      records.push_back({r.source, r.receiver, r.sequence, r.arrival});
    }
  }
  return records;
}

TEST(RangeChannel, DeliversAtOnceWithoutLossExactlyInsideTheRange) {
  NetworkConfig s;
  s.run.agents = 3;
  s.channel.model = "range";
  s.channel.periodic.transmit_period_s = 0.1;
  s.channel.range_m = 0.5;
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  // Link 0-1 is 0.3 m long. Link 0-2 is exactly as long as the range, so q = 0.
  StepAtRest(channel.get(), kDt, 1, {{0, 0, 0}, {0.3, 0, 0}, {0, 0.5, 0}}, {From(0, kDt)});
  const std::vector<Reception> got = DeliverAll(channel.get(), kDt);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].source, 0);
  EXPECT_EQ(got[0].receiver, 1);
  EXPECT_EQ(got[0].destination, kToAll);
  EXPECT_EQ(got[0].sequence, 0u);
  EXPECT_EQ(got[0].arrival, kDt);
  EXPECT_EQ(got[0].transmit, kDt);
  EXPECT_EQ(got[0].loss_probability, 0.0);
  EXPECT_NEAR(got[0].link_quality, 0.4, 1e-15);
  EXPECT_EQ(channel->Link(0, 2, kDt).last_drop, DropReason::kRange);
  EXPECT_NEAR(channel->Link(1, 0, kDt).quality, 0.4, 1e-15) << "quality needs no packet in Eq. 5";
}

TEST(ExtendedChannel, ArrivalIsTransmissionPlusDistanceOverSoundSpeed) {
  NetworkConfig s = LosslessNetwork(2);
  s.channel.extended.sound_speed_mps = 1500.0;
  const auto channel = MakeChannel(s.channel, s.run);
  for (const double d : {0.0, 0.0015, 0.75, 1.5, 3.0, 3.5}) {
    channel->Reset(1, 0);
    StepAtRest(channel.get(), 5 * kDt, 5, {{1, 2, 3}, {1, 2, 3 + d}}, {From(1, 5 * kDt)});
    std::vector<Reception> got;
    channel->Deliver(0, 6 * kDt, &got);
    ASSERT_EQ(got.size(), 1u) << d;
    EXPECT_EQ(got[0].arrival - got[0].transmit, std::llround(d / 1500.0 * 1e9)) << d;
    EXPECT_NEAR(got[0].travel_time_s, d / 1500.0, 1e-15);
    EXPECT_NEAR(got[0].distance_m, d, 1e-15);
  }
}

TEST(ExtendedChannel, PositionsAtTransmissionSetTheDelay) {
  NetworkConfig s = LosslessNetwork(2);
  s.channel.extended.sound_speed_mps = 2.0;
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  StepAtRest(channel.get(), 0, 0, {{0, 0, 0}, {1, 0, 0}}, {From(0, 0)});
  StepAtRest(channel.get(), kDt, 1, {{0, 0, 0}, {3, 0, 0}}, {});
  std::vector<Reception> got;
  channel->Deliver(1, 499'999'999, &got);
  EXPECT_TRUE(got.empty());
  channel->Deliver(1, 500'000'000, &got);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].arrival, 500'000'000);
  channel->Deliver(1, 600'000'000, &got);
  EXPECT_EQ(got.size(), 1u) << "a packet is delivered once";
}

TEST(ExtendedChannel, ReceptionAndLinkCarryTheValuesOfEq6) {
  NetworkConfig s = LosslessNetwork(2);
  s.channel.extended.loss_distance_m = 2.0;
  s.channel.extended.sound_speed_mps = 10.0;
  const auto channel = MakeChannel(s.channel, s.run);
  std::vector<Reception> got;
  Transmission packet = From(0, 3 * kDt);
  packet.generation = 2 * kDt;
  for (std::uint64_t seed = 0; got.empty(); ++seed) {  // until a packet is not lost
    channel->Reset(seed, 0);
    EXPECT_EQ(channel->Link(0, 1, 0).quality, 0.0);
    StepAtRest(channel.get(), 3 * kDt, 3, {{0, 0, 0}, {1, 0, 0}}, {packet});
    EXPECT_EQ(channel->Link(0, 1, 3 * kDt).quality, 0.0) << "nothing known yet";
    channel->Deliver(1, 4 * kDt, &got);
  }
  const double loss = 1.0 - std::exp(-0.25);
  EXPECT_NEAR(got[0].loss_probability, loss, 1e-14);
  // The state is 0.2 s old on arrival: 0.1 s before transmission and 0.1 s under way.
  EXPECT_NEAR(got[0].link_quality, std::exp(-0.5) * std::exp(-0.25) * std::exp(-0.1), 1e-14);
  const LinkStatistics link = channel->Link(0, 1, 10 * kDt);
  EXPECT_NEAR(link.age_s, 0.8, 1e-12);
  EXPECT_NEAR(link.quality, std::exp(-0.5) * std::exp(-0.25) * std::exp(-0.4), 1e-14);
  EXPECT_NEAR(link.loss_probability, loss, 1e-14);
  EXPECT_NEAR(link.distance_m, 1.0, 1e-15);
  EXPECT_NEAR(link.delay_s, 0.1, 1e-15);
  EXPECT_NEAR(link.mean_delay_s, 0.1, 1e-12);
  EXPECT_EQ(channel->Link(1, 0, 10 * kDt).quality, 0.0) << "the other direction heard nothing";
}

TEST(ExtendedChannel, NothingArrivesBeyondMaxRangeAndTheDropSaysWhy) {
  const NetworkConfig s = LosslessNetwork(3);
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  StepAtRest(channel.get(), 0, 0, {{0, 0, 0}, {3.5, 0, 0}, {0, 0, -3.5000001}}, {From(0, 0)});
  const std::vector<Reception> got = DeliverAll(channel.get(), kDt);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].receiver, 1);
  const LinkStatistics link = channel->Link(0, 2, kDt);
  EXPECT_EQ(link.dropped, 1u);
  EXPECT_EQ(link.drops[static_cast<std::size_t>(DropReason::kRange)], 1u);
  EXPECT_EQ(link.last_drop, DropReason::kRange);
  EXPECT_EQ(link.loss_probability, 1.0);
  EXPECT_EQ(link.quality, 0.0);
}

TEST(ExtendedChannel, EmpiricalLossRateIsTheLossProbability) {
  const NetworkConfig s = ExtendedScenario(2);
  const int n = 20000;
  for (const double d : {0.0, 0.3, 1.0, 2.0, 3.0}) {
    const auto channel = MakeChannel(s.channel, s.run);
    channel->Reset(11, 2);
    std::vector<Reception> got;
    for (int k = 0; k < n; ++k) {
      StepAtRest(channel.get(), k * kDt, static_cast<std::uint32_t>(k), {{0, 0, 0}, {0, d, 0}},
                 {From(0, k * kDt)});
      got.clear();
      channel->Deliver(1, (k + 1) * kDt, &got);
    }
    const double p = LossProbability(d, s.channel.extended);
    const LinkStatistics link = channel->Link(0, 1, n * kDt);
    EXPECT_EQ(link.delivered + link.dropped, static_cast<std::uint64_t>(n));
    EXPECT_EQ(link.last_drop, DropReason::kLoss);
    EXPECT_NEAR(static_cast<double>(link.dropped), n * p, 4.5 * std::sqrt(n * p * (1 - p))) << d;
  }
}

TEST(ExtendedChannel, LossesOfDifferentLinksAndStepsAreUncorrelated) {
  NetworkConfig s = LosslessNetwork(3);
  s.channel.extended.loss_probability = 0.5;
  const std::vector<Record> got = Play(s, 3, 0, 20000, {true, true, false}, 0);
  // In each step, of the links 0-1, 0-2, 1-0: +1 is received, -1 is lost.
  std::vector<std::vector<double>> x(3, std::vector<double>(20000, -1.0));
  for (const Record& r : got) {
    const int link = r.source == 0 ? r.destination - 1 : (r.destination == 0 ? 2 : -1);
    if (link >= 0) x[static_cast<std::size_t>(link)][r.sequence] = 1.0;
  }
  const double bound = 4.5 * std::sqrt(20000.0);
  const auto dot = [&](int a, int b, std::size_t lag) {
    return std::inner_product(x[static_cast<std::size_t>(a)].begin() + static_cast<long>(lag),
                              x[static_cast<std::size_t>(a)].end(),
                              x[static_cast<std::size_t>(b)].begin(), 0.0);
  };
  EXPECT_LT(std::abs(dot(0, 1, 0)), bound);
  EXPECT_LT(std::abs(dot(0, 2, 0)), bound) << "the two directions of a pair";
  EXPECT_LT(std::abs(dot(0, 0, 1)), bound) << "successive packets";
}

TEST(ExtendedChannel, OutcomeDependsOnSeedAndEpisodeOnly) {
  const NetworkConfig s = ExtendedScenario(5);
  const std::vector<bool> all(5, true);
  const auto first = Play(s, 42, 7, 200, all, 0);
  ASSERT_FALSE(first.empty());
  EXPECT_TRUE(first == Play(s, 42, 7, 200, all, 0)) << "same seed and episode";
  EXPECT_TRUE(first == Play(s, 42, 7, 200, all, 99)) << "other order of `sent`";
  EXPECT_FALSE(first == Play(s, 42, 8, 200, all, 0)) << "other episode";
  EXPECT_FALSE(first == Play(s, 43, 7, 200, all, 0)) << "other seed";
}

TEST(ExtendedChannel, SilenceOfOthersDoesNotChangeALink) {
  const NetworkConfig s = ExtendedScenario(5);
  auto together = Play(s, 42, 7, 200, std::vector<bool>(5, true), 0);
  together.erase(std::remove_if(together.begin(), together.end(),
                                [](const Record& r) { return r.source != 3; }),
                 together.end());
  EXPECT_TRUE(together == Play(s, 42, 7, 200, {false, false, false, true, false}, 0));
}

TEST(ExtendedChannel, WhatArrivesFartherAlsoArrivesNearer) {
  // The draws are the same and all distances are doubled, so the survivors are a true subset.
  const NetworkConfig s = ExtendedScenario(4);
  const auto near = Play(s, 1, 1, 500, std::vector<bool>(4, true), 0, nullptr, 0.5);
  const auto far = Play(s, 1, 1, 500, std::vector<bool>(4, true), 0, nullptr, 1.0);
  EXPECT_LT(far.size(), near.size());
  for (const Record& f : far) {
    EXPECT_TRUE(std::any_of(near.begin(), near.end(), [&](const Record& n) {
      return n.source == f.source && n.destination == f.destination && n.sequence == f.sequence &&
             n.arrival <= f.arrival;
    }));
  }
}

TEST(ExtendedChannel, ReceptionsComeOldestFirstAndTiesBySource) {
  NetworkConfig s = LosslessNetwork(9);
  s.channel.extended.sound_speed_mps = 1.0;
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  // Sources 1 to 8 around receiver 0, two at each of four distances, the farthest first.
  std::vector<Vec3<double>> p(9);
  std::vector<Transmission> sent;
  for (int i = 1; i <= 8; ++i) {
    const double d = 3.0 - 0.5 * ((i - 1) / 2);
    p[static_cast<std::size_t>(i)] = i % 2 ? Vec3<double>{d, 0, 0} : Vec3<double>{0, d, 0};
    sent.insert(sent.begin(), From(i, 0));
  }
  StepAtRest(channel.get(), 0, 0, p, sent);
  StepAtRest(channel.get(), kDt, 1, p, {});
  std::vector<Reception> got;
  channel->Deliver(0, 10 * kDt, &got);
  ASSERT_EQ(got.size(), 0u);
  channel->Deliver(0, 25 * kDt, &got);
  channel->Deliver(0, 30 * kDt, &got);
  std::vector<int> sources;
  for (const Reception& r : got) sources.push_back(r.source);
  EXPECT_EQ(sources, (std::vector<int>{7, 8, 5, 6, 3, 4, 1, 2}));
}

TEST(ExtendedChannel, ResetForgetsPacketsInFlightAndStatistics) {
  NetworkConfig s = ExtendedScenario(4);
  s.channel.extended.sound_speed_mps = 3.0;  // the packets of the last steps are still under way
  const auto used = MakeChannel(s.channel, s.run);
  Play(s, 9, 0, 50, std::vector<bool>(4, true), 0, used.get());
  ASSERT_GT(used->totals().delivered, 0u);
  used->Reset(9, 1);
  EXPECT_EQ(used->totals().delivered + used->totals().dropped, 0u);
  EXPECT_TRUE(DeliverAll(used.get(), 1000 * kDt).empty());
  const LinkStatistics link = used->Link(0, 1, 0);
  EXPECT_EQ(link.delivered + link.dropped, 0u);
  EXPECT_EQ(link.last_drop, DropReason::kNone);
  EXPECT_EQ(link.average_age_s, 0.0);
  const auto again = Play(s, 9, 1, 50, std::vector<bool>(4, true), 0, used.get());
  EXPECT_TRUE(again == Play(s, 9, 1, 50, std::vector<bool>(4, true), 0));
}

TEST(ExtendedChannel, EveryPacketIsDeliveredOrDroppedWithAReason) {
  const NetworkConfig s = ExtendedScenario(6);
  const auto channel = MakeChannel(s.channel, s.run);
  Play(s, 4, 0, 300, std::vector<bool>(6, true), 0, channel.get(), 2.0);
  const ChannelTotals& t = channel->totals();
  EXPECT_EQ(t.delivered + t.dropped, 300u * 6u * 5u);
  EXPECT_EQ(t.drops[static_cast<std::size_t>(DropReason::kNone)], 0u);
  EXPECT_GT(t.drops[static_cast<std::size_t>(DropReason::kRange)], 0u);
  EXPECT_GT(t.drops[static_cast<std::size_t>(DropReason::kLoss)], 0u);
  EXPECT_EQ(std::accumulate(t.drops.begin(), t.drops.end(), std::uint64_t{0}), t.dropped);
  std::uint64_t delivered = 0, dropped = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const LinkStatistics link = channel->Link(i, j, 300 * kDt);
      delivered += link.delivered;
      dropped += link.dropped;
    }
  }
  EXPECT_EQ(delivered, t.delivered);
  EXPECT_EQ(dropped, t.dropped);
}

TEST(Channel, NonFinitePositionsAreRefused) {
  for (const char* model : {"range", "extended"}) {
    NetworkConfig s = ExtendedScenario(2);
    s.channel.model = model;
    const auto channel = MakeChannel(s.channel, s.run);
    channel->Reset(0, 0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    EXPECT_THROW(StepAtRest(channel.get(), 0, 0, {{0, 0, 0}, {0, nan, 0}}, {}),
                 std::invalid_argument);
    EXPECT_THROW(StepAtRest(channel.get(), 0, 0, {{inf, 0, 0}, {0, 0, 0}}, {}),
                 std::invalid_argument);
  }
}

TEST(Channel, EveryReasonHasItsOwnName) {
  std::vector<std::string> names;
  for (int i = 0; i < kDropReasons; ++i) names.push_back(ToString(static_cast<DropReason>(i)));
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::unique(names.begin(), names.end()), names.end());
}

}  // namespace
}  // namespace stg::acoustics

#include <algorithm>
#include <map>
#include <random>
#include <tuple>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "network_fixture.hpp"

/// Queues, presence of nodes, order of calls, energy, clocks and ranging.
namespace stg::acoustics {
namespace {

TEST(Queue, NewestReplacesTheOneThatWaits) {
  Bench b(2);
  b.Start();
  for (const std::uint32_t k : {0u, 1u, 2u, 3u}) b.Offer(0, 1.0 + 0.1 * k, kToAll, k);
  b.network->Advance(10 * kSecond);
  ASSERT_EQ(b.log.sent.size(), 2u);
  EXPECT_EQ(b.log.sent[0].tag, 0u);
  EXPECT_EQ(b.log.sent[1].tag, 3u);
  EXPECT_EQ(b.log.sent[1].transmit, Ns(2.25)) << "airtime and turnaround";
  ASSERT_EQ(b.log.discarded.size(), 2u);
  EXPECT_EQ(b.log.discarded[0].packet.tag, 1u);
  EXPECT_EQ(b.log.discarded[0].reason, DropReason::kQueue);
  EXPECT_EQ(b.log.discarded[0].t, Ns(1.2));
}

TEST(Queue, FifoKeepsTheOrderAndRefusesWhatIsTooMuch) {
  Bench b(2);
  b.config.physical.modem.queue = QueuePolicy::kFifo;
  b.config.physical.modem.queue_length = 2;
  b.Start();
  for (const std::uint32_t k : {0u, 1u, 2u, 3u}) b.Offer(0, 1.0 + 0.1 * k, kToAll, k);
  b.network->Advance(10 * kSecond);
  ASSERT_EQ(b.log.sent.size(), 3u);
  for (const std::uint32_t k : {0u, 1u, 2u}) {
    EXPECT_EQ(b.log.sent[k].tag, k);
    EXPECT_EQ(b.log.sent[k].transmit, Ns(1.0 + 1.25 * k));
    EXPECT_EQ(b.log.Of(0, 1, k).reason, DropReason::kNone);
  }
  ASSERT_EQ(b.log.discarded.size(), 1u);
  EXPECT_EQ(b.log.discarded[0].packet.tag, 3u);
}

TEST(Presence, WhoIsAbsentNeitherSendsNorHears) {
  Bench b(3);
  b.medium->SetDelay(0, 1, 0.5);
  b.Start();
  b.network->SetPresent(2, Ns(0.5), false);
  b.Offer(0, 1.0);                           // at node 1 from 1.5
  b.network->SetPresent(1, Ns(2.0), false);  // it leaves while it hears the packet
  b.Offer(1, 3.0);
  b.network->SetPresent(1, Ns(4.0), true);
  b.Offer(0, 5.0);
  b.network->Advance(10 * kSecond);
  EXPECT_EQ(b.log.Of(0, 1, 0).reason, DropReason::kLeft);
  EXPECT_EQ(b.log.Of(0, 2, 0).reason, DropReason::kLeft);
  EXPECT_EQ(b.log.Of(0, 1, 1).reason, DropReason::kNone);
  ASSERT_EQ(b.log.discarded.size(), 1u);
  EXPECT_EQ(b.log.discarded[0].packet.source, 1);
  EXPECT_EQ(b.log.discarded[0].reason, DropReason::kLeft);
}

TEST(Presence, WhatWaitsInAModemThatLeavesIsLost) {
  Bench b(2);
  b.Start();
  b.Offer(0, 1.0, kToAll, 1);
  b.Offer(0, 1.5, kToAll, 2);
  b.network->SetPresent(0, Ns(1.7), false);
  b.network->SetPresent(0, Ns(3.0), true);
  b.network->Advance(10 * kSecond);
  EXPECT_EQ(b.log.sent.size(), 1u);
  EXPECT_EQ(b.log.Of(0, 1).reason, DropReason::kNone) << "sound in the water goes on";
  ASSERT_EQ(b.log.discarded.size(), 1u);
  EXPECT_EQ(b.log.discarded[0].packet.tag, 2u);
}

/// A busy network in real water. Calls at one time come in any order.
std::vector<Log::Fate> Busy(std::uint64_t shuffle, const char* access) {
  RunConfig run;
  run.agents = 5;
  ChannelConfig config;
  config.access = access;
  config.physical.modem.packet_bytes = 32;
  config.contention.rest_s = 0.7;
  config.slots.length_s = 0.6;
  config.slots.guard_s = 0.05;
  config.slots.send_probability = 0.4;
  config.physical.noise.burst_every_s = 5.0;
  Network network(config, run);
  Log log;
  network.Reset(7, 3);
  network.Observe(&log);
  std::mt19937_64 order(shuffle);
  const std::uint8_t bytes[32] = {};
  for (int k = 0; k < 300; ++k) {
    const TimeNs t = k * kSecond / 5;
    std::vector<int> calls(10);
    for (int c = 0; c < 10; ++c) calls[static_cast<std::size_t>(c)] = c;
    if (shuffle > 0) std::shuffle(calls.begin(), calls.end(), order);
    for (const int c : calls) {
      const int node = c / 2;
      if (c % 2 == 0) {
        network.Move(node, t, {300.0 * node + k, 200.0 * (node % 2), -20.0 * node - 5.0},
                     {5.0, 0.3 * node, 0.0});
      } else {
        Transmission packet;
        packet.source = node;
        packet.stamp = packet.generation = t + 1000 * node;
        packet.payload = {bytes, sizeof(bytes)};
        network.Offer(packet);
      }
    }
    // The network advances in pieces, as if somebody looked at it. Shuffled runs use other pieces.
    if (shuffle % 2 == 0) network.Advance(t + kSecond / 7);
    network.Advance(t + kSecond / 5 - 1);
    network.Forget();
  }
  return log.fates;
}

TEST(Network, ResultsDoNotDependOnTheOrderOfCalls) {
  for (const char* access : {"aloha", "slotted_aloha", "tdma", "csma"}) {
    const auto expected = Busy(0, access);
    EXPECT_GT(expected.size(), 300u) << access;
    std::size_t delivered = 0;
    for (const std::uint64_t shuffle : {1u, 2u, 3u}) {
      const auto got = Busy(shuffle, access);
      ASSERT_EQ(got.size(), expected.size()) << access;
      for (std::size_t i = 0; i < got.size(); ++i) {
        ASSERT_EQ(got[i].packet.source, expected[i].packet.source);
        ASSERT_EQ(got[i].packet.transmit, expected[i].packet.transmit);
        ASSERT_EQ(got[i].fate.receiver, expected[i].fate.receiver);
        ASSERT_EQ(got[i].fate.reason, expected[i].fate.reason);
        ASSERT_EQ(got[i].fate.received_level_db, expected[i].fate.received_level_db);
        ASSERT_EQ(got[i].fate.sinr_db, expected[i].fate.sinr_db);
        if (got[i].fate.reason == DropReason::kNone) ++delivered;
      }
    }
    EXPECT_GT(delivered, 30u) << access;
  }
}

TEST(Network, EveryPacketHasOneFate) {
  for (const char* access : {"aloha", "csma"}) {
    std::map<std::tuple<int, std::uint32_t, int>, int> sent;
    for (const Log::Fate& f : Busy(0, access)) {
      ++sent[{f.packet.source, f.packet.sequence, f.fate.receiver}];
    }
    for (const auto& [packet, times] : sent) EXPECT_EQ(times, 1);
  }
}

TEST(Network, NodesMoveOnStraightLinesBetweenMoves) {
  RunConfig run;
  run.agents = 2;
  Network network({}, run);
  network.Reset(1, 0);
  network.Move(1, Ns(1.0), {100.0, 0.0, -10.0}, {2.0, -1.0, 0.5});
  network.Advance(Ns(2.0));
  const NodeMotion there = network.Motion(1, Ns(5.0));
  EXPECT_EQ(there.p_W.x, 108.0);
  EXPECT_EQ(there.p_W.y, -4.0);
  EXPECT_EQ(there.p_W.z, -8.0);
  EXPECT_THROW(network.Move(1, Ns(1.5), {}, {}), std::invalid_argument);
  EXPECT_THROW(network.Move(1, Ns(3.0), {std::nan(""), 0.0, 0.0}, {}), std::invalid_argument);
}

TEST(Energy, CountsSendingReceivingAndIdling) {
  Bench b(2);
  b.medium->SetDelay(0, 1, 0.5);
  b.Start();
  b.Offer(0, 1.0);
  b.network->SetPresent(1, Ns(6.0), false);
  b.network->Advance(Ns(1.25));
  EXPECT_NEAR(b.network->EnergyJ(0, Ns(1.5)), 50.0 * 0.5 + 0.5 * 1.0, 1e-9) << "while it sends";
  b.network->Advance(Ns(10.0));
  EXPECT_NEAR(b.network->EnergyJ(0, Ns(10.0)), 50.0 * 1.0 + 0.5 * 9.0, 1e-9);
  EXPECT_NEAR(b.network->EnergyJ(1, Ns(10.0)), 2.0 * 1.0 + 0.5 * 5.0, 1e-9);
}

TEST(Clocks, ShiftTheOneWayTravelTime) {
  Bench b(2);
  b.config.physical.modem.clock_offset_std_s = 0.01;
  b.config.physical.modem.clock_drift_std_ppm = 20.0;
  b.medium->SetDelay(0, 1, 0.5);
  Network& network = b.Start(5);
  b.Offer(0, 1000.0);
  network.Advance(Ns(1010.0));
  std::vector<Reception> got;
  network.Take(1, Ns(1010.0), &got);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_NE(network.ClockS(0, 0), network.ClockS(1, 0));
  EXPECT_NEAR(got[0].travel_time_s, network.ClockS(1, Ns(1000.5)) - network.ClockS(0, Ns(1000.0)),
              1e-9);
  EXPECT_GT(std::abs(got[0].travel_time_s - 0.5), 1e-4);
  EXPECT_EQ(b.log.Of(0, 1).travel_time_s, 0.5);
}

TEST(Ping, GivesTheRangeWithoutSynchronisedClocks) {
  Bench b(3);
  b.config.physical.modem.clock_offset_std_s = 3.0;
  b.medium->SetDelay(0, 1, 0.5);
  Network& network = b.Start();
  network.Ping(0, 1, Ns(1.0), 10 * kSecond, 17);
  network.Advance(20 * kSecond);
  ASSERT_EQ(b.log.pings.size(), 1u);
  const PingResult& r = b.log.pings[0];
  EXPECT_TRUE(r.answered);
  EXPECT_EQ(r.tag, 17u);
  EXPECT_EQ(r.ended, Ns(1.0 + 1.0 + 0.5 + 0.25 + 1.0 + 0.5)) << "request, way, turnaround, reply";
  EXPECT_NEAR(r.round_trip_s, 1.0, 1e-9);
  EXPECT_NEAR(r.range_m, 750.0, 1e-5);
  EXPECT_EQ(r.true_range_m, 750.0);
  std::vector<Reception> got;
  for (const int i : {0, 1, 2}) network.Take(i, 20 * kSecond, &got);
  EXPECT_TRUE(got.empty()) << "pings are the modems' business";
}

TEST(Ping, IsGivenUpWhereNobodyAnswers) {
  Bench b(2);
  b.medium->SetLevel(0, 1, -50.0);
  b.Start();
  b.network->Ping(0, 1, Ns(1.0), 5 * kSecond, 0);
  b.network->Advance(20 * kSecond);
  ASSERT_EQ(b.log.pings.size(), 1u);
  EXPECT_FALSE(b.log.pings[0].answered);
  EXPECT_EQ(b.log.pings[0].ended, Ns(6.0));
}

TEST(Ping, ALaterOneOfTheSameSourceReplacesItAndIsAnswered) {
  Bench b(2);
  b.medium->SetDelay(0, 1, 0.5);
  b.Start();
  b.network->Ping(0, 1, Ns(1.0), 10 * kSecond, 3);
  b.network->Ping(0, 1, Ns(1.0), 10 * kSecond, 4);
  b.network->Advance(20 * kSecond);
  ASSERT_EQ(b.log.pings.size(), 2u);
  EXPECT_EQ(b.log.pings[0].tag, 3u);
  EXPECT_TRUE(b.log.pings[0].replaced && !b.log.pings[0].answered);
  EXPECT_EQ(b.log.pings[1].tag, 4u);
  EXPECT_TRUE(!b.log.pings[1].replaced && b.log.pings[1].answered);
}

TEST(Ping, ADriftingClockMeasuresAShareOfTheRoundTripWrongly) {
  Bench b(2);
  b.config.physical.modem.clock_drift_std_ppm = 100.0;
  b.medium->SetDelay(0, 1, 0.5);
  Network& network = b.Start();
  network.Ping(0, 1, 0, 10 * kSecond, 0);
  network.Advance(20 * kSecond);
  ASSERT_EQ(b.log.pings.size(), 1u);
  const double rate_0 = network.ClockS(0, kSecond) - network.ClockS(0, 0) - 1.0;
  const double rate_1 = network.ClockS(1, kSecond) - network.ClockS(1, 0) - 1.0;
  EXPECT_NE(rate_0, 0.0);
  // A round trip takes 3.25 s. Of these, 0.25 s are by the other node's clock.
  const double expected = (3.0 + 0.25 / (1.0 + rate_1)) * (1.0 + rate_0) - 2.25;
  EXPECT_NEAR(b.log.pings[0].round_trip_s, expected, 2e-9);
}

}  // namespace
}  // namespace stg::acoustics

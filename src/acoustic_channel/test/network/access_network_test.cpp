#include "auv_common/config/loader.hpp"
#include "network_fixture.hpp"

/// Medium access on modems whose packets take time.
namespace stg::acoustics {
namespace {

/// Every node always has a packet to send, for this long.
void Chatter(Bench* b, double duration_s) {
  for (double t = 0.0; t < duration_s; t += 0.5) {
    for (int i = 0; i < b->run.agents; ++i) b->Offer(i, t);
  }
  b->network->Advance(Ns(duration_s + 10.0));
}

TEST(TdmaNetwork, NothingIsLostWhileTheGuardCoversTheWay) {
  Bench b(4);
  b.config.access = "tdma";
  b.config.slots.length_s = 1.4;
  b.config.slots.guard_s = 0.4;
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) b.medium->SetDelay(i, j, 0.1 * (i + j - 1));  // up to 0.4 s
  }
  b.Start();
  Chatter(&b, 200.0);
  EXPECT_GT(b.log.sent.size(), 140u);
  for (const PacketInfo& p : b.log.sent) {
    EXPECT_EQ(p.transmit % (4 * Ns(1.4)), p.source * Ns(1.4));
  }
  EXPECT_EQ(b.log.fates.size(), 3 * b.log.sent.size());
  for (const Log::Fate& f : b.log.fates) EXPECT_EQ(f.fate.reason, DropReason::kNone);
}

TEST(TdmaNetwork, AWayLongerThanTheGuardIsLost) {
  Bench b(2);
  b.config.access = "tdma";
  b.config.slots.length_s = 1.4;
  b.config.slots.guard_s = 0.4;
  b.medium->SetDelay(0, 1, 0.6);
  b.Start();
  Chatter(&b, 20.0);
  int lost = 0;
  for (const Log::Fate& f : b.log.fates) {
    if (f.fate.reason == DropReason::kHalfDuplex) ++lost;
  }
  EXPECT_GT(lost, 10);
}

TEST(Slots, ThatCannotHoldAPacketAreAConfigurationError) {
  for (const char* access : {"tdma", "slotted_aloha"}) {
    NetworkConfig s;
    s.channel.model = "physical";
    s.channel.access = access;
    s.channel.physical.modem.packet_bytes = 32;  // a packet takes 0.5035 s
    s.channel.slots.length_s = 1.0;
    s.channel.slots.guard_s = 0.5;
    const auto violation = config::FindViolation(s);
    ASSERT_TRUE(violation) << access;
    EXPECT_EQ(violation->keys.front(), "channel.slots.length_s");
    s.channel.slots.guard_s = 0.49;
    EXPECT_FALSE(config::FindViolation(s)) << access;
    s.channel.physical.modem.profile = "micromodem_fsk_r0";
    EXPECT_TRUE(config::FindViolation(s)) << access << ": 3.2 s";
  }
}

TEST(Slots, ConcernNobodyOnIdealChannels) {
  NetworkConfig s;
  s.channel.access = "tdma";
  s.channel.slots.length_s = 0.1;
  s.channel.slots.guard_s = 0.0;
  EXPECT_FALSE(config::FindViolation(s)) << "packets take no time";
  s.channel.model = "physical";
  EXPECT_TRUE(config::FindViolation(s));
}

TEST(Configuration, APacketThatNoFrameTakesIsRefused) {
  NetworkConfig s;
  s.channel.model = "physical";
  s.channel.physical.modem.profile = "janus";
  EXPECT_FALSE(config::FindViolation(s));
  s.channel.physical.modem.packet_bytes = 9;
  auto violation = config::FindViolation(s);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->keys.front(), "channel.physical.modem.packet_bytes");
  s.channel.physical.modem.packet_bytes = 0;
  s.channel.physical.modem.profiles = {"janus",
                                       "evologics_s2c"};  // these are shared out to 4 nodes
  violation = config::FindViolation(s);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->keys.front(), "channel.physical.modem.profiles");
}

TEST(Configuration, CarrierSenseNeedsModems) {
  NetworkConfig s;
  s.channel.access = "csma";
  const auto violation = config::FindViolation(s);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->keys.front(), "channel.access");
  s.channel.model = "physical";
  EXPECT_FALSE(config::FindViolation(s));
}

TEST(CsmaNetwork, WaitsWhileItHearsACarrierAndSendsAfterwards) {
  Bench b(2);
  b.config.access = "csma";
  b.medium->SetDelay(0, 1, 0.1);
  // The packet of node 0 is at node 1 from 1.1 to 2.1 s.
  b.Play({{0, 1.0}, {1, 1.5}});
  EXPECT_EQ(b.log.Of(0, 1).reason, DropReason::kNone);
  EXPECT_EQ(b.log.Of(1, 0).reason, DropReason::kNone);
  ASSERT_EQ(b.log.sent.size(), 2u);
  EXPECT_GE(b.log.sent[1].transmit, Ns(2.1));
}

TEST(CsmaNetwork, HearsNothingOfACarrierThatIsStillOnItsWay) {
  Bench b(3);
  b.config.access = "csma";
  for (const int i : {0, 1}) b.medium->SetDelay(i, 2, 1.0);
  b.medium->SetDelay(0, 1, 1.0);
  b.Play({{0, 1.0}, {1, 1.5}});
  EXPECT_EQ(b.log.Of(0, 2).reason, DropReason::kCollision);
  EXPECT_EQ(b.log.Of(1, 2).reason, DropReason::kCollision);
}

TEST(AlohaNetwork, RestsForTheStatedTimeOnAverage) {
  Bench b(2);
  b.config.contention.rest_s = 2.0;
  b.medium->SetLevel(0, 1, -50.0);
  b.Start();
  for (int k = 0; k < 80000; ++k) b.Offer(0, 0.05 * k);
  b.network->Advance(Ns(4000.0));
  // A cycle has a second of airtime, a rest with mean 2 s that is not below the turnaround of 0.25
  // s, and up to 0.05 s until the next packet comes. E max(x, 0.25) = 2 exp(-0.125) + 0.25.
  const double cycle_s = 1.0 + 2.0 * std::exp(-0.125) + 0.25;
  EXPECT_NEAR(static_cast<double>(b.log.sent.size()), 4000.0 / cycle_s, 90.0);
}

TEST(SlottedAlohaNetwork, SendsInTheStatedShareOfSlots) {
  Bench b(2);
  b.config.access = "slotted_aloha";
  b.config.slots.length_s = 1.5;
  b.config.slots.guard_s = 0.5;
  b.config.slots.send_probability = 0.3;
  b.Start();
  constexpr int kSlots = 4000;
  for (int k = 0; k < 3 * kSlots; ++k) b.Offer(0, 0.5 * k);
  b.network->Advance(Ns(1.5 * kSlots));
  for (const PacketInfo& p : b.log.sent) ASSERT_EQ(p.transmit % Ns(1.5), 0);
  EXPECT_NEAR(static_cast<double>(b.log.sent.size()), 0.3 * kSlots, 4.5 * std::sqrt(0.21 * kSlots));
}

TEST(Profiles, HaveThePublishedAirtimes) {
  const auto airtime = [](const char* name, std::size_t bytes) {
    return ModemProfiles().Make(name)->airtime_s(bytes);
  };
  EXPECT_NEAR(airtime("micromodem_fsk_r0", 32), 3.2, 1e-12);
  EXPECT_NEAR(airtime("micromodem_psk_r1", 192), 3.07, 1e-12);
  EXPECT_NEAR(airtime("micromodem_psk_r3", 512), 3.07, 1e-12);
  EXPECT_NEAR(airtime("micromodem_psk_r5", 2048), 3.0, 1e-12);
  EXPECT_NEAR(airtime("janus", 8), 1.1, 1e-12);
  EXPECT_NEAR(airtime("evologics_s2c", 16), 0.328, 0.01 * 0.328);
  EXPECT_NEAR(airtime("evologics_s2c", 32), 0.500, 0.01 * 0.500);
  EXPECT_NEAR(airtime("evologics_s2c", 39), 0.582, 0.01 * 0.582);
  EXPECT_EQ(airtime("ideal", 2048), 0.0);
}

TEST(Profiles, IdealIsInstantAndLossless) {
  Bench b(3);
  b.config.physical.modem.profile = "ideal";
  b.medium->SetLevel(0, 1, -100.0);
  b.medium->SetDelay(0, 2, 5.0);
  b.Start();
  for (int i = 0; i < 3; ++i) b.Offer(i, 1.0);
  b.network->Advance(Ns(1.0));
  EXPECT_EQ(b.log.fates.size(), 6u);
  for (const Log::Fate& f : b.log.fates) {
    EXPECT_EQ(f.fate.reason, DropReason::kNone);
    EXPECT_EQ(f.fate.arrival, Ns(1.0));
  }
}

}  // namespace
}  // namespace stg::acoustics

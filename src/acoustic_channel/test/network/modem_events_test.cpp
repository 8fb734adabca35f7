#include <sstream>
#include <string>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/log/packet_log.hpp"
#include "network_fixture.hpp"

/// Events that the network gives to modems with a protocol of their own.
namespace stg::acoustics {
namespace {

struct Acquired {
  PacketInfo packet;
  int receiver;
  TimeNs begin;
};
struct Ended {
  PacketInfo packet;
  HeardEnd end;
  std::string payload;
  TimeNs t;
};

struct ModemLog : Log {
  void OnSendEnd(const PacketInfo& p) override { send_ends.push_back(p); }
  void OnAcquired(const PacketInfo& p, int receiver, TimeNs begin) override {
    acquired.push_back({p, receiver, begin});
  }
  void OnReceptionEnd(const PacketInfo& p, const HeardEnd& e, TimeNs t) override {
    const auto* text = reinterpret_cast<const char*>(e.payload.data);
    ended.push_back({p, e, std::string(text, text + e.payload.size), t});
  }
  std::vector<PacketInfo> send_ends;
  std::vector<Acquired> acquired;
  std::vector<Ended> ended;
};

struct ModemBench : Bench {
  explicit ModemBench(int nodes) : Bench(nodes) {}
  Network& Start() {
    Bench::Start();
    network->Observe(&modem_log);
    return *network;
  }
  Transmission Packet(int source, double t_s, int destination, const std::string& text) {
    texts_.push_back(std::make_unique<std::string>(text));
    Transmission packet;
    packet.source = source;
    packet.destination = destination;
    packet.stamp = packet.generation = Ns(t_s);
    packet.payload = {reinterpret_cast<const std::uint8_t*>(texts_.back()->data()), text.size()};
    return packet;
  }
  ModemLog modem_log;

 private:
  std::vector<std::unique_ptr<std::string>> texts_;
};

TEST(ModemEvents, EveryNodeThatAcquiresHearsTheEndWhoeverThePacketIsFor) {
  ModemBench bench(3);
  bench.medium->SetDelay(0, 1, 0.5);
  bench.medium->SetDelay(0, 2, 0.25);
  Network& network = bench.Start();
  network.Offer(bench.Packet(0, 1.0, 1, "hello"));
  network.Advance(Ns(5.0));
  ASSERT_EQ(bench.modem_log.acquired.size(), 2u);
  EXPECT_EQ(bench.modem_log.acquired[0].receiver, 2);
  EXPECT_EQ(bench.modem_log.acquired[0].begin, Ns(1.25));
  EXPECT_EQ(bench.modem_log.acquired[1].receiver, 1);
  EXPECT_EQ(bench.modem_log.acquired[1].begin, Ns(1.5));
  ASSERT_EQ(bench.modem_log.ended.size(), 2u);
  for (const Ended& e : bench.modem_log.ended) {
    EXPECT_EQ(e.end.fate.reason, DropReason::kNone);
    EXPECT_EQ(e.payload, "hello");
    EXPECT_DOUBLE_EQ(e.end.fate.received_level_db, 60.0);
  }
  EXPECT_EQ(bench.modem_log.ended[0].t, Ns(2.25));
  ASSERT_EQ(bench.modem_log.send_ends.size(), 1u);
  EXPECT_EQ(bench.modem_log.send_ends[0].transmit_end, Ns(2.0));
  // The network gives the packet to its addressee only.
  EXPECT_EQ(bench.modem_log.fates.size(), 1u);
  std::vector<Reception> received;
  network.Take(2, Ns(5.0), &received);
  EXPECT_TRUE(received.empty());
}

TEST(ModemEvents, ALostPacketEndsWithItsReasonAndWithoutItsBytes) {
  ModemBench bench(2);
  bench.medium->SetLevel(0, 1, 5.0);  // acquired above 3 dB; at 5 dB 2^-2154 of the packets survive
  Network& network = bench.Start();
  network.Offer(bench.Packet(0, 1.0, 1, "hello"));
  network.Advance(Ns(5.0));
  ASSERT_EQ(bench.modem_log.ended.size(), 1u);
  EXPECT_EQ(bench.modem_log.ended[0].end.fate.reason, DropReason::kLoss);
  EXPECT_NEAR(bench.modem_log.ended[0].end.fate.sinr_db, 5.0, 1e-9);
  EXPECT_EQ(bench.modem_log.ended[0].payload, "");
  EXPECT_EQ(bench.modem_log.Of(0, 1).reason, DropReason::kLoss);
}

TEST(ModemEvents, OneThatIsNotAcquiredIsNoEvent) {
  ModemBench bench(2);
  bench.medium->SetLevel(0, 1, 2.0);
  Network& network = bench.Start();
  network.Offer(bench.Packet(0, 1.0, 1, "hello"));
  network.Advance(Ns(5.0));
  EXPECT_TRUE(bench.modem_log.acquired.empty());
  EXPECT_TRUE(bench.modem_log.ended.empty());
}

TEST(ModemEvents, SendingIntoAReceptionEndsIt) {
  ModemBench bench(2);
  Network& network = bench.Start();
  network.Offer(bench.Packet(0, 1.0, kToAll, "hello"));
  network.Offer(bench.Packet(1, 1.5, kToAll, "me too"));
  network.Advance(Ns(5.0));
  ASSERT_EQ(bench.modem_log.ended.size(), 1u);
  EXPECT_EQ(bench.modem_log.ended[0].end.fate.reason, DropReason::kHalfDuplex);
  EXPECT_EQ(bench.modem_log.ended[0].t, Ns(1.5));
}

TEST(ModemEvents, ANodeThatLeavesLetsGoOfWhatItHeard) {
  ModemBench bench(2);
  Network& network = bench.Start();
  network.Offer(bench.Packet(0, 1.0, kToAll, "hello"));
  network.SetPresent(1, Ns(1.5), false);
  network.Advance(Ns(5.0));
  ASSERT_EQ(bench.modem_log.ended.size(), 1u);
  EXPECT_EQ(bench.modem_log.ended[0].end.fate.reason, DropReason::kLeft);
  EXPECT_EQ(bench.modem_log.ended[0].t, Ns(1.5));
}

TEST(ModemEvents, AirtimeIsThatOfTheStatedBytesAndMode) {
  ModemProfile slow;
  slow.waveform = "slow";
  slow.centre_khz = 25.0;
  slow.bandwidth_khz = 5.0;
  slow.frame_s = 0.5;
  slow.frame_bytes = 10;
  slow.errors.kind = ErrorCurve::Kind::kNone;
  ModemBench bench(3);
  Network& network = bench.Start();
  network.SetWaveforms(1, {"slow"});
  Transmission packet = bench.Packet(0, 1.0, kToAll, "two");
  packet.mode = &slow;
  packet.air_bytes = 35;
  packet.header = 0xfedcba9876543210;
  network.Offer(packet);
  network.Advance(Ns(5.0));
  ASSERT_EQ(bench.modem_log.sent.size(), 1u);
  EXPECT_EQ(bench.modem_log.sent[0].transmit_end, Ns(3.0));
  EXPECT_EQ(bench.modem_log.sent[0].bytes, 3u);
  // Node 1 has the mode of the packet, node 2 has not.
  EXPECT_EQ(bench.modem_log.Of(0, 1).reason, DropReason::kNone);
  EXPECT_EQ(bench.modem_log.Of(0, 2).reason, DropReason::kNotAcquired);
  std::vector<Reception> received;
  network.Take(1, Ns(5.0), &received);
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0].header, packet.header);
}

TEST(ModemEvents, AcknowledgementsAreNoDataOfTheLinks) {
  ModemBench bench(2);
  std::ostringstream csv;
  PacketLog log(&csv, 2);
  Network& network = bench.Start();
  network.Observe(&log);
  Transmission ack = bench.Packet(0, 1.0, 1, "k");
  ack.kind = PacketKind::kAck;
  network.Offer(ack);
  network.Advance(Ns(5.0));
  EXPECT_EQ(network.totals().delivered, 0u);
  EXPECT_NE(csv.str().find("\n0,1,1,ack,0,1,"), std::string::npos);
  std::vector<Reception> received;
  network.Take(1, Ns(5.0), &received);
  EXPECT_TRUE(received.empty());
}

TEST(ModemEvents, APacketForNobodyIsSentAndNobodyIsGivenIt) {
  ModemBench bench(2);
  Network& network = bench.Start();
  network.Offer(bench.Packet(0, 1.0, kToNone, "hello"));
  network.Advance(Ns(5.0));
  EXPECT_EQ(bench.modem_log.sent.size(), 1u);
  EXPECT_TRUE(bench.modem_log.fates.empty());
  EXPECT_EQ(bench.modem_log.ended.size(), 1u);
}

TEST(ModemEvents, APacketThatWaitsIsTakenBack) {
  ModemBench bench(2);
  bench.config.physical.modem.queue = QueuePolicy::kFifo;
  Network& network = bench.Start();
  for (const std::uint32_t tag : {7u, 8u}) {
    Transmission packet = bench.Packet(0, 1.0, kToAll, "hello");
    packet.tag = tag;
    network.Offer(packet);
  }
  network.Advance(Ns(1.5));
  EXPECT_FALSE(network.Cancel(0, 7));  // it is already leaving
  EXPECT_TRUE(network.Cancel(0, 8));
  EXPECT_FALSE(network.Cancel(0, 8));
  network.Advance(Ns(9.0));
  EXPECT_EQ(bench.modem_log.sent.size(), 1u);
  ASSERT_EQ(bench.modem_log.discarded.size(), 1u);
  EXPECT_EQ(bench.modem_log.discarded[0].packet.tag, 8u);
}

TEST(ModemEvents, TheNextEventIsKnown) {
  ModemBench bench(2);
  Network& network = bench.Start();
  EXPECT_EQ(network.next(), kNever);
  network.Offer(bench.Packet(0, 1.0, kToAll, "hello"));
  EXPECT_EQ(network.next(), Ns(1.0));
  network.Advance(Ns(1.0));
  EXPECT_EQ(network.next(), Ns(2.0));
  network.Advance(Ns(2.0));
  EXPECT_EQ(network.next(), kNever);
}

TEST(ModemEvents, ASofterPacketArrivesSofter) {
  ModemBench bench(2);
  Network& network = bench.Start();
  Transmission packet = bench.Packet(0, 1.0, 1, "hello");
  packet.level_db = -20.0;
  network.Offer(packet);
  network.Advance(Ns(5.0));
  EXPECT_DOUBLE_EQ(bench.modem_log.Of(0, 1).received_level_db, 40.0);
}

}  // namespace
}  // namespace stg::acoustics

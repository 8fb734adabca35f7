#include "modem_fixture.hpp"

/// Bursts over a connection of 1500 m. A call, an answer and an acknowledgement take .1625 s each,
/// the turnaround takes .02 s, and a burst of five bytes takes .1515 + 40 / 6900 s.
namespace stg::acoustics {
namespace {

std::string Burst(const std::string& data, int destination) {
  return "AT*SEND," + std::to_string(data.size()) + "," + std::to_string(destination) + "," + data +
         "\n";
}

std::size_t Count(const std::string& text, const std::string& part) {
  std::size_t times = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++times;
  return times;
}

struct Bursts : testing::Test {
  Bursts() : bench(2) {}
  /// At 10 s both ends are connected.
  void Connect() {
    bench.StartS2c();
    bench.Ask(0, 1.0, Burst("hello", 2));
    bench.water->Advance(Ns(10.0));
    ASSERT_NE(bench.hosts.all[0].find("DELIVERED,1,2"), std::string::npos);
  }
  std::string State(int node, double t_s) { return bench.Ask(node, t_s, "AT?S\n"); }
  ModemBench bench;
};

TEST_F(Bursts, ABurstEstablishesTheConnectionItNeeds) {
  bench.StartS2c();
  EXPECT_EQ(State(0, 0.5), "INITIATION LISTEN\n\r\n");
  EXPECT_EQ(bench.Ask(0, 1.0, Burst("hello", 2)), "OK\r\n");
  EXPECT_EQ(State(0, 1.5), "INITIATION ESTABLISH\n\r\n");
  bench.water->Advance(Ns(10.0));
  const double called = 1.0 + 0.1625 + 1.0, answered = called + 0.02 + 0.1625 + 1.0;
  EXPECT_NEAR(bench.When(1, "RADDR,1\r\n"), called, 1e-9);
  EXPECT_NEAR(bench.When(0, "RADDR,2\r\n"), answered, 1e-9);
  EXPECT_NEAR(bench.When(0, "BITRATE,remote,6900\r\n"), answered, 1e-9);
  const double heard = answered + 0.1515 + 40.0 / 6900.0 + 1.0;
  EXPECT_NEAR(bench.When(1, "RECV,5,1,2,6900,-130,508,1000000,0.0000,hello\r\n"), heard, 1e-8);
  EXPECT_NEAR(bench.When(0, "DELIVERED,1,2\r\n"), heard + 0.02 + 0.1625 + 1.0, 1e-8);
  EXPECT_EQ(State(0, 10.0), "ONLINE LOCAL\n\r\n");
  EXPECT_EQ(State(1, 10.0), "ONLINE LOCAL\n\r\n");
  EXPECT_EQ(bench.Ask(0, 10.0, "AT?T\n"), "1000000\r\n");
}

TEST_F(Bursts, DataGoesBothWaysOverOneConnection) {
  Connect();
  const std::string much(1024, '\r');
  bench.Ask(0, 10.0, Burst(much, 2));
  bench.Ask(0, 10.0, Burst("next", 2));
  bench.Ask(1, 30.0, Burst("back", 1));
  bench.water->Advance(Ns(50.0));
  EXPECT_NE(bench.hosts.all[1].find("," + much + "\r\n"), std::string::npos);
  EXPECT_NE(bench.hosts.all[1].find("RECV,4,1,2,6900,-130,508,1000000,0.0000,next"),
            std::string::npos);
  EXPECT_NE(bench.hosts.all[0].find("RECV,4,2,1,6900,-130,508,1000000,0.0000,back"),
            std::string::npos);
  EXPECT_EQ(Count(bench.hosts.all[0], "RADDR"), 1u);
  EXPECT_EQ(Count(bench.hosts.all[0], "DELIVERED,"), 3u);
}

TEST_F(Bursts, WhereNobodyAnswersAllDataFailsAndTheModemBacksOff) {
  bench.StartS2c();
  bench.medium->SetLevel(0, 1, -100.0);
  bench.Ask(0, 0.5, "AT!RC2\nAT!RT1000\n");
  bench.Ask(0, 1.0, Burst("hello", 2));
  bench.Ask(0, 1.1, Burst("again", 2));
  // There are three calls of .1625 s. The modem waits 1.125 s after each.
  const double failed = 1.0 + 3 * 1.2875;
  bench.water->Advance(Ns(failed + 0.1));
  EXPECT_NEAR(bench.When(0, "FAILED,1,2\r\n"), failed, 1e-9);
  EXPECT_NEAR(bench.When(0, "FAILED,2,2\r\n"), failed, 1e-9);
  EXPECT_NEAR(bench.When(0, "DROPCNT,10\r\n"), failed, 1e-9);
  EXPECT_EQ(State(0, failed + 0.1), "BACKOFF\n\r\n");
  EXPECT_EQ(bench.Ask(0, failed + 0.2, "AT*SENDIM,2,2,ack,hi\n"), "BUSY BACKOFF STATE\r\n");
  EXPECT_EQ(bench.Ask(0, failed + 0.2, "AT*SENDIM,2,2,force,hi\n"), "OK\r\n");
  EXPECT_EQ(State(0, failed + 2.1), "INITIATION LISTEN\n\r\n");
}

TEST_F(Bursts, ARepeatedBurstIsTakenOnce) {
  Connect();
  bench.medium->SetLevel(1, 0, -100.0);
  bench.Ask(0, 10.0, Burst("twice", 2));
  bench.water->Advance(Ns(60.0));
  EXPECT_EQ(Count(bench.hosts.all[1], "twice"), 1u);
  EXPECT_NE(bench.hosts.all[0].find("FAILED,2,2\r\n"), std::string::npos);
  // It left four times, because AT!RC3 allows three repeats.
  const auto& sent = bench.log.sent;
  EXPECT_EQ(std::count_if(sent.begin(), sent.end(),
                          [](const PacketInfo& p) {
                            return p.kind == PacketKind::kData && p.transmit >= Ns(10.0);
                          }),
            4);
}

TEST_F(Bursts, BothEndsOrOneHangUp) {
  Connect();
  EXPECT_EQ(bench.Ask(0, 10.0, "ATH0\n"), "OK\r\n");
  bench.water->Advance(Ns(13.0));
  EXPECT_EQ(State(0, 13.0), "INITIATION LISTEN\n\r\n");
  EXPECT_EQ(State(1, 13.0), "INITIATION LISTEN\n\r\n");
  EXPECT_EQ(bench.Ask(1, 14.0, "ATD1\n"), "INITIATION ESTABLISH\r\n");
  EXPECT_EQ(State(1, 20.0), "ONLINE LOCAL\n\r\n");
  EXPECT_EQ(bench.Ask(1, 20.0, "ATH1\n"), "OK\r\n");
  EXPECT_EQ(State(0, 25.0), "ONLINE LOCAL\n\r\n");
  EXPECT_EQ(State(1, 25.0), "INITIATION LISTEN\n\r\n");
}

TEST_F(Bursts, AnIdleConnectionClosesWhereItIsTold) {
  Connect();
  bench.Ask(0, 10.0, "AT!KO5\n");
  bench.Ask(0, 10.0, Burst("more", 2));
  bench.water->Advance(Ns(25.0));
  EXPECT_EQ(State(0, 25.0), "INITIATION LISTEN\n\r\n");
  EXPECT_EQ(State(1, 25.0), "INITIATION LISTEN\n\r\n");
}

TEST_F(Bursts, WhatDoesNotFitTheBufferIsRefused) {
  bench.StartS2c();
  bench.medium->SetLevel(0, 1, -100.0);
  bench.Ask(0, 1.0, Burst(std::string(1024, 'x'), 2));
  EXPECT_EQ(bench.Ask(0, 1.0, Burst("hello", 7)), "ERROR BUFFER IS NOT EMPTY\r\n");
  for (int k = 1; k < 16; ++k) {
    EXPECT_EQ(bench.Ask(0, 1.0, Burst(std::string(1024, 'x'), 2)), "OK\r\n");
  }
  EXPECT_EQ(bench.Ask(0, 1.0, Burst("hello", 2)), "ERROR BUFFER FULL\r\n");
  EXPECT_EQ(bench.Ask(0, 1.5, "ATZ4\n"), "DROPCNT,16384\r\nOK\r\n");
  EXPECT_EQ(bench.Ask(0, 1.6, Burst("hello", 2)), "OK\r\n");
}

TEST_F(Bursts, DataModeIsAPipe) {
  s2c::ModemOptions options;
  bench.StartS2c(options);
  bench.Ask(0, 0.5, "+++AT!AR2\n");
  bench.hosts.all[0].clear();
  bench.Ask(0, 1.0, "raw ");
  bench.Ask(0, 1.1, "bytes");
  bench.Ask(0, 1.2, " pass\r\n");
  bench.water->Advance(Ns(20.0));
  std::string text = bench.hosts.all[1];
  while (text.rfind("+++AT:", 0) == 0) text.erase(0, text.find('\n') + 1);
  EXPECT_EQ(text, "raw bytes pass\r\n");
}

TEST_F(Bursts, AnInstantMessageGoesBetweenBursts) {
  Connect();
  bench.Ask(0, 10.0, Burst(std::string(1024, 'x'), 2));
  bench.Ask(0, 10.1, Burst("last", 2));
  EXPECT_EQ(bench.Ask(0, 10.2, "AT*SENDIM,2,2,ack,hi\n"), "OK\r\n");
  bench.water->Advance(Ns(40.0));
  const std::string& sent = bench.hosts.all[0];
  EXPECT_NE(sent.find("DELIVEREDIM,2"), std::string::npos);
  EXPECT_LT(sent.find("DELIVEREDIM,2"), sent.find("DELIVERED,3,2"));
  EXPECT_EQ(Count(sent, "FAILED"), 0u);
}

TEST_F(Bursts, TwoThatCallEachOtherAtOnceEndConnected) {
  bench.StartS2c();
  bench.Ask(0, 1.0, Burst("ping", 2));
  bench.Ask(1, 1.0, Burst("pong", 1));
  bench.water->Advance(Ns(60.0));
  EXPECT_EQ(Count(bench.hosts.all[1], "ping"), 1u);
  EXPECT_EQ(Count(bench.hosts.all[0], "pong"), 1u);
}

}  // namespace
}  // namespace stg::acoustics

#include "modem_fixture.hpp"

/// Two modems exchange messages. The times are those of 32 bytes over 1500 m, for any vendor:
/// airtime .5035 s, acknowledgement .1625 s, turnaround .02 s.
namespace stg::acoustics {
namespace {

std::string Im(const std::string& payload, int destination, const std::string& flag) {
  return "AT*SENDIM," + std::to_string(payload.size()) + "," + std::to_string(destination) + "," +
         flag + "," + payload + "\n";
}

struct Messages : testing::Test {
  Messages() : bench(2) {}
  void Start() {
    bench.StartS2c();
    for (int i = 0; i < bench.run.agents; ++i) bench.Ask(i, 0.0, "AT@ZX1\n");
    bench.hosts.said.clear();
  }
  ModemBench bench;
};

TEST_F(Messages, AnAcknowledgedMessageTakesItsTime) {
  Start();
  const std::string payload(32, 'x');
  EXPECT_EQ(bench.Ask(0, 10.0, Im(payload, 2, "ack")), "OK\r\nSENDSTART,2,im,503500,0\r\n");
  EXPECT_EQ(bench.Ask(0, 11.0, "AT?DI\n"), "DELIVERING,2\r\n");
  bench.water->Advance(Ns(15.0));
  EXPECT_NEAR(bench.When(0, "SENDEND,2,im,10000000,503500\r\n"), 10.5035, 1e-9);
  EXPECT_NEAR(bench.When(1, "RECVSTART\r\n"), 11.0, 1e-9);
  // -130 is the level of 60 less 190 dB. The signal is 60 dB above noise, 68 dB above acquisition.
  EXPECT_NEAR(bench.When(1, "RECVEND,11000000,503500,-130,508\r\n"), 11.5035, 1e-9);
  EXPECT_NEAR(bench.When(1, "RECVIM,32,1,2,ack,503500,-130,508,0.0000," + payload + "\r\n"),
              11.5035, 1e-9);
  EXPECT_NEAR(bench.When(1, "SENDSTART,1,ack,162500,0\r\n"), 11.5235, 1e-9);
  EXPECT_NEAR(bench.When(1, "SENDEND,1,ack,11523500,162500\r\n"), 11.686, 1e-9);
  EXPECT_NEAR(bench.When(0, "RECVSTART\r\n"), 12.5235, 1e-9);
  EXPECT_NEAR(bench.When(0, "DELIVEREDIM,2\r\n"), 12.686, 1e-9);
  EXPECT_EQ(bench.Ask(0, 15.0, "AT?T\n"), "1000000\r\n");
  EXPECT_EQ(bench.Ask(0, 15.0, "AT?DI\n"), "DELIVERED,2\r\n");
  // The log marks the acknowledgement as one.
  ASSERT_EQ(bench.log.sent.size(), 2u);
  EXPECT_EQ(bench.log.sent[1].kind, PacketKind::kAck);
}

TEST_F(Messages, ANewEpisodeEndsThem) {
  Start();
  bench.Ask(0, 10.0, Im("hello", 2, "ack"));
  bench.Ask(1, 10.0, "AT*SENDIMS,2,1,20000000,hi\n");
  bench.water->Advance(Ns(10.1));
  bench.water->Reset(1, 1);  // this is in the middle of the sound
  EXPECT_NEAR(bench.When(0, "FAILEDIM,2\r\n"), 0.0, 1e-9);
  EXPECT_NEAR(bench.When(1, "CANCELEDIMS,1\r\n"), 0.0, 1e-9);
  EXPECT_EQ(bench.Ask(0, 1.0, "AT?S\n"), "INITIATION LISTEN\n\r\n");
  bench.Ask(0, 1.0, Im("again", 2, "ack"));
  bench.water->Advance(Ns(6.0));
  EXPECT_EQ(bench.hosts.all[0].substr(bench.hosts.all[0].size() - 15), "DELIVEREDIM,2\r\n");
}

TEST_F(Messages, AnyBytesPassUnchanged) {
  Start();
  std::string payload;
  for (int k = 0; k < 64; ++k) payload += static_cast<char>(k * 4 + (k < 32 ? 0 : 3));
  payload.replace(3, 5, "\r\n,++");
  bench.Ask(0, 1.0, Im(payload, 255, "noack"));
  bench.water->Advance(Ns(5.0));
  EXPECT_NE(bench.hosts.all[1].find("," + payload + "\r\n"), std::string::npos);
}

TEST_F(Messages, AMessageWithoutAcknowledgementEndsWithItsSound) {
  Start();
  bench.Ask(0, 1.0, Im("hello", 255, "noack"));
  EXPECT_EQ(bench.Ask(0, 1.1, Im("again", 255, "noack")), "BUSY DELIVERING MESSAGE\r\n");
  bench.water->Advance(Ns(1.3));
  EXPECT_EQ(bench.Ask(0, 1.4, Im("again", 2, "force")), "OK\r\nSENDSTART,2,im,206500,0\r\n");
  bench.water->Advance(Ns(9.0));
  EXPECT_NE(bench.hosts.all[1].find("RECVIM,5,1,255,noack,206500,"), std::string::npos);
  EXPECT_NE(bench.hosts.all[1].find("RECVIM,5,1,2,force,206500,"), std::string::npos);
  EXPECT_EQ(bench.log.sent.size(), 2u);
}

TEST_F(Messages, WithoutAnswerTheMessageIsRepeatedAndThenFails) {
  Start();
  bench.medium->SetLevel(0, 1, -100.0);
  bench.Ask(0, 1.0, "AT!RI2\nAT!RT1000\n");
  bench.Ask(0, 2.0, Im("hello", 2, "ack"));
  bench.water->Advance(Ns(20.0));
  ASSERT_EQ(bench.log.sent.size(), 3u);
  EXPECT_EQ(bench.log.sent[1].transmit, Ns(2.0 + 1.2065));
  EXPECT_NEAR(bench.When(0, "FAILEDIM,2\r\n"), 2.0 + 3 * 1.2065, 1e-9);
  EXPECT_EQ(bench.Ask(0, 21.0, "AT?DI\n"), "FAILED,2\r\n");
}

TEST_F(Messages, ALostAcknowledgementBringsTheMessageTwice) {
  Start();
  bench.medium->SetLevel(1, 0, -100.0);
  bench.Ask(0, 1.0, Im("hello", 2, "ack"));
  bench.water->Advance(Ns(20.0));
  std::size_t times = 0, at = 0;
  while ((at = bench.hosts.all[1].find("RECVIM,5,", at)) != std::string::npos) ++times, ++at;
  EXPECT_EQ(times, 2u);
  EXPECT_NE(bench.hosts.all[0].find("FAILEDIM,2\r\n"), std::string::npos);
}

TEST_F(Messages, WhatIsLostAfterAcquisitionFailsAudibly) {
  Start();
  // Half of the frames survive at 4 dB more. Acquisition still succeeds.
  bench.medium->SetLevel(0, 1, -7.5);
  bench.Ask(0, 1.0, Im(std::string(64, 'x'), 2, "noack"));
  bench.water->Advance(Ns(5.0));
  EXPECT_EQ(bench.hosts.all[1].substr(4), "RECVSTART\r\nRECVFAILED,0.0000,-198,99\r\n");
}

TEST_F(Messages, AMessageWaitsForTheEndOfAReception) {
  Start();
  bench.Ask(0, 1.0, Im(std::string(32, 'x'), 2, "noack"));
  EXPECT_EQ(bench.Ask(1, 2.2, Im("hello", 1, "noack")), "OK\r\n");
  bench.water->Advance(Ns(9.0));
  EXPECT_NEAR(bench.When(1, "SENDSTART,1,im,206500,0\r\n"), 2.5035, 1e-9);
  EXPECT_NE(bench.hosts.all[1].find("RECVIM,32"), std::string::npos);
}

TEST_F(Messages, OrItEndsTheReception) {
  s2c::ModemOptions options = ModemBench::NetOptions();
  options.defer = false;
  bench.StartS2c(options);
  bench.Ask(1, 0.0, "AT@ZX1\n");
  bench.Ask(0, 1.0, Im(std::string(32, 'x'), 2, "noack"));
  bench.Ask(1, 2.2, Im("hello", 1, "noack"));
  bench.water->Advance(Ns(9.0));
  EXPECT_NEAR(bench.When(1, "SENDSTART,1,im,206500,0\r\n"), 2.2, 1e-9);
  EXPECT_EQ(bench.hosts.all[1].find("RECVIM"), std::string::npos);
  EXPECT_NE(bench.hosts.all[1].find("RECVFAILED"), std::string::npos);
}

TEST_F(Messages, APiggybackRidesOnTheNextAcknowledgement) {
  Start();
  EXPECT_EQ(bench.Ask(1, 0.5, "AT*SENDPBM,6,1,answer\n"), "OK\r\n");
  EXPECT_EQ(bench.Ask(1, 0.6, "AT*SENDPBM,6,1,second\n"), "BUSY DELIVERING MESSAGE\r\n");
  bench.Ask(0, 1.0, Im("hello", 2, "ack"));
  bench.water->Advance(Ns(9.0));
  // Seven bytes have an airtime of .1515 + 7 x .011 s.
  EXPECT_GT(bench.When(0, "RECVPBM,6,2,1,228500,-130,508,0.0000,answer\r\n"), 0.0);
  EXPECT_NEAR(bench.When(0, "DELIVEREDIM,2\r\n"), 1.0 + 0.2065 + 2.0 + 0.02 + 0.2285, 1e-9);
  EXPECT_EQ(bench.Ask(0, 9.0, "AT?T\n"), "1000000\r\n");
}

TEST_F(Messages, ASynchronousMessageLeavesByTheModemsClock) {
  Start();
  EXPECT_EQ(bench.Ask(0, 1.0, "AT*SENDIMS,5,2,2500000,hello\n"), "OK\r\n");
  EXPECT_EQ(bench.Ask(0, 1.1, Im("again", 2, "noack")), "BUSY DELIVERING MESSAGE\r\n");
  bench.water->Advance(Ns(9.0));
  EXPECT_NEAR(bench.When(0, "SENDSTART,2,ims,206500,0\r\n"), 2.5, 1e-9);
  EXPECT_GT(bench.When(1, "RECVIMS,5,1,2,3500000,206500,-130,508,0.0000,hello\r\n"), 0.0);
  EXPECT_EQ(bench.Ask(0, 9.0, "AT*SENDIMS,5,2,8000000,hello\n"), "OK\r\nEXPIREDIMS,2\r\n");
  EXPECT_EQ(bench.Ask(0, 9.5, "AT*SENDIMS,5,2,,hello\n"), "OK\r\nSENDSTART,2,ims,206500,0\r\n");
}

TEST_F(Messages, TheClockWrapsAndATimeAheadOfItIsStillAhead) {
  Start();
  bench.water->Advance(Ns(4294.0));
  bench.Ask(0, 4294.0, "AT*SENDIMS,5,2,1032704,hello\n");  // 4296 s less 2^32 us
  bench.water->Advance(Ns(4300.0));
  EXPECT_NEAR(bench.When(0, "SENDSTART,2,ims,206500,0\r\n"), 4296.0, 1e-9);
}

TEST_F(Messages, DroppedMessagesAreCanceled) {
  Start();
  bench.Ask(0, 1.0, Im("hello", 2, "ack"));
  EXPECT_EQ(bench.Ask(0, 1.1, "ATZ3\n"), "OK\r\nCANCELEDIM,2\r\n");
  bench.water->Advance(Ns(9.0));
  EXPECT_EQ(bench.hosts.all[0].find("DELIVEREDIM"), std::string::npos);
  bench.Ask(0, 10.0, "AT*SENDIMS,5,2,30000000,hello\n");
  EXPECT_EQ(bench.Ask(0, 10.1, "ATZ3\n"), "OK\r\nCANCELEDIMS,2\r\n");
  bench.water->Advance(Ns(40.0));
  EXPECT_EQ(bench.log.sent.size(), 2u);  // the message and its acknowledgement
}

TEST(S2cForeign, OnlyPromiscuousModemsTellOfMessagesForOthers) {
  ModemBench bench(3);
  bench.StartS2c();
  bench.Ask(2, 0.5, "AT!RP1\n");
  bench.Ask(0, 1.0, Im("hello", 2, "noack"));
  bench.water->Advance(Ns(5.0));
  EXPECT_NE(bench.hosts.all[2].find("RECVIM,5,1,2,noack"), std::string::npos);
  bench.Ask(2, 6.0, "AT!RP0\n");
  const std::string before = bench.hosts.all[2];
  bench.Ask(0, 7.0, Im("hello", 2, "noack"));
  bench.water->Advance(Ns(10.0));
  EXPECT_EQ(bench.hosts.all[2], before);
}

TEST(S2cForeign, AnUnknownAddressIsSentToAndNobodyHears) {
  ModemBench bench(2);
  bench.StartS2c();
  EXPECT_EQ(bench.Ask(0, 1.0, Im("hello", 77, "noack")), "OK\r\n");
  bench.water->Advance(Ns(5.0));
  EXPECT_EQ(bench.log.sent.size(), 1u);
  EXPECT_EQ(bench.hosts.all[1], "");
}

TEST(S2cForeign, AnOrdinaryVehiclesPacketIsAnInstantMessage) {
  ModemBench bench(2);
  bench.Make();
  bench.water->Attach(0, 9, [](ModemSurroundings* world) {
    return std::make_unique<s2c::S2cModem>(ModemBench::NetOptions(), world);
  });
  bench.water->Observe(&bench.log);
  bench.water->Reset(1, 0);
  bench.water->Connect(0, 0);
  Transmission packet;
  packet.source = 1;
  packet.stamp = packet.generation = Ns(1.0);
  const std::string text = "hello";
  packet.payload = {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  bench.water->Offer(packet, Ns(1.0));
  bench.water->Advance(Ns(5.0));
  EXPECT_EQ(bench.hosts.all[0], "RECVIM,5,2,255,noack,206500,-130,508,0.0000,hello\r\n");
  // A message also goes in the other direction.
  bench.Ask(0, 6.0, Im("hi", 2, "noack"));
  bench.water->Advance(Ns(9.0));
  std::vector<Reception> received;
  bench.water->network().Take(1, Ns(9.0), &received);
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0].source, 0);
}

TEST(S2cForeign, TheSameWordsAtTheSameTimesGiveTheSameBytes) {
  const auto play = [] {
    ModemBench bench(3);
    bench.StartS2c();
    for (int k = 0; k < 200; ++k) {
      const double t_s = 0.37 * k;
      bench.Say(k % 3, t_s,
                Im(std::string(1 + k % 60, 'x'), 1 + (k + 1) % 3, k % 2 ? "ack" : "noack"));
      if (k % 11 == 0) bench.Say(k % 3, t_s, "AT!RT" + std::to_string(500 + 10 * k) + "\n");
    }
    bench.water->Advance(Ns(100.0));
    return bench.hosts.all[0] + bench.hosts.all[1] + bench.hosts.all[2];
  };
  const std::string once = play();
  EXPECT_NE(once.find("DELIVEREDIM"), std::string::npos);
  EXPECT_NE(once.find("BUSY"), std::string::npos);
  EXPECT_EQ(play(), once);
}

}  // namespace
}  // namespace stg::acoustics

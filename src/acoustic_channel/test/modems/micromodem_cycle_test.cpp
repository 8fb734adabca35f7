#include "acoustic_channel/micromodem/sentence.hpp"
#include "modem_fixture.hpp"

/// Micromodems exchange packets over 1500 m. A mini-packet takes .9 s, a set of frames about three
/// seconds, and the turnaround .05 s.
namespace stg::acoustics {
namespace {

using micromodem::Seal;
using State = micromodem::Micromodem::State;

/// Names of the sentences that a host got, in order.
std::string NamesOf(const std::string& all) {
  std::string names;
  for (std::size_t at = all.find('$'); at != std::string::npos; at = all.find('$', at + 1)) {
    names += (names.empty() ? "" : " ") + all.substr(at + 3, 3);
  }
  return names;
}

struct Cycles : testing::Test {
  Cycles() : bench(2) { bench.StartMicromodems(); }
  std::string Names(int node) { return NamesOf(bench.hosts.all[node]); }
  bool Overheard(int node, const std::string& part) {
    return bench.hosts.all[node].find(part) != std::string::npos;
  }
  ModemBench bench;
};

TEST_F(Cycles, ACycleAtRateZeroIsToldInTheDocumentedOrder) {
  bench.Ask(0, 10.0, "$CCCYC,0,1,2,0,1,1\r\n");
  bench.water->Advance(Ns(11.0));
  EXPECT_EQ(bench.hosts.all[0].substr(bench.hosts.all[0].find("$CADRQ")),
            Seal("CADRQ,221330,1,2,1,32,1"));
  EXPECT_EQ(bench.Ask(0, 11.0, "$CCTXD,1,2,1,48656C6C6F\r\n"),
            Seal("CATXD,1,2,1,5") + Seal("CATXP,5"));
  bench.water->Advance(Ns(30.0));
  EXPECT_EQ(Names(0), "CYC TXP TXF XST DRQ TXD TXP TXF XST RXP ACK CST");
  EXPECT_EQ(Names(1), "RXP CYC CST RXP RXD CST TXP TXF");
  EXPECT_TRUE(Overheard(1, Seal("CACYC,0,1,2,0,1,1")));
  EXPECT_TRUE(Overheard(1, Seal("CARXD,1,2,1,1,48656C6C6F")));
  EXPECT_TRUE(Overheard(0, Seal("CAACK,2,1,1,1")));
  // The start of the cycle ends at 10.9. The frame leaves at 11 and takes 3.2 s. The answer comes 1
  // + .05 + .9 + 1 s later.
  EXPECT_NEAR(bench.When(1, Seal("CARXD,1,2,1,1,48656C6C6F")), 15.2, 1e-9);
  EXPECT_NEAR(bench.When(0, Seal("CAACK,2,1,1,1")), 17.15, 1e-9);
  EXPECT_EQ(bench.micromodems[0]->state(), State::kIdle);
  EXPECT_EQ(bench.micromodems[1]->state(), State::kIdle);
}

TEST_F(Cycles, APskCycleAsksForEveryFrame) {
  EXPECT_EQ(bench.Ask(0, 10.0, "$CCCYC,0,1,2,2,1,3\r\n"),
            Seal("CACYC,0,1,2,2,1,3") + Seal("CADRQ,221330,1,2,1,64,1"));
  bench.Ask(0, 10.0, "$CCTXD,1,2,1,AA\r\n");
  bench.Ask(0, 10.0, "$CCTXD,1,2,0,BBBB\r\n");
  bench.Ask(0, 10.0, "$CCTXD,1,2,1,CC\r\n");
  bench.water->Advance(Ns(30.0));
  EXPECT_EQ(Names(0), "CYC DRQ TXD DRQ TXD DRQ TXD TXP TXF XST RXP ACK ACK CST");
  EXPECT_EQ(Names(1), "RXP CYC RXD RXD RXD CST TXP TXF");
  EXPECT_TRUE(Overheard(
      1, Seal("CARXD,1,2,1,1,AA") + Seal("CARXD,1,2,0,2,BBBB") + Seal("CARXD,1,2,1,3,CC")));
  EXPECT_TRUE(Overheard(0, Seal("CAACK,2,1,1,1") + Seal("CAACK,2,1,3,1")));
  // There are three frames of 64 bytes, even if they hold less.
  EXPECT_NEAR(bench.When(1, Seal("CARXD,1,2,1,1,AA")), 14.07, 1e-9);
}

TEST_F(Cycles, AnEmptyFrameEndsTheFrames) {
  bench.Ask(0, 10.0, "$CCCYC,0,1,2,5,0,8\r\n");
  bench.Ask(0, 10.0, "$CCTXD,1,0,0," + std::string(512, 'A') + "\r\n");
  bench.Ask(0, 10.0, "$CCTXD,1,0,0,\r\n");
  bench.water->Advance(Ns(30.0));
  EXPECT_TRUE(Overheard(1, Seal("CARXD,1,0,0,1," + std::string(512, 'A'))));
  EXPECT_EQ(Names(1), "RXP CYC RXD CST");
  EXPECT_NEAR(bench.log.sent.at(0).transmit_end * 1e-9, 10.375, 1e-9);  // one frame of eight
}

TEST_F(Cycles, APolledModemsHostIsAskedForData) {
  bench.Ask(0, 10.0, "$CCCYC,0,2,1,1,0,1\r\n");
  bench.water->Advance(Ns(12.0));
  EXPECT_EQ(Names(0), "CYC TXP TXF XST");
  EXPECT_EQ(Names(1), "RXP CYC CST DRQ");
  bench.Ask(1, 12.0, "$CCTXD,2,1,0,0102\r\n");
  bench.water->Advance(Ns(20.0));
  EXPECT_TRUE(Overheard(0, Seal("CARXD,2,1,0,1,0102")));
  EXPECT_EQ(Names(0), "CYC TXP TXF XST RXP CYC RXD CST");
}

TEST_F(Cycles, APingMeasuresTheOneWayTime) {
  EXPECT_EQ(bench.Ask(0, 10.0, "$CCMPC,1,2\r\n"), Seal("CAMPC,1,2") + Seal("CATXP,2"));
  bench.water->Advance(Ns(20.0));
  EXPECT_EQ(Names(0), "MPC TXP TXF RXP MPR CST");
  EXPECT_EQ(Names(1), "RXP MPA CST TXP TXF");
  EXPECT_TRUE(Overheard(1, Seal("CAMPA,1,2")));
  EXPECT_NEAR(bench.When(0, Seal("CAMPR,2,1,1.0000")), 13.85, 1e-9);
}

/// One-way ranging: a packet leaves at a full second of a common clock. The fraction of the second
/// at which it arrives is its travel time.
TEST_F(Cycles, SynchronousPacketsLeaveAtFullSeconds) {
  for (const int node : {0, 1}) {
    bench.Ask(node, 9.3, "$CCTMS,2023-11-14T22:13:30Z,1\r\n");
    bench.Ask(node, 9.3, "$CCCFG,SNV,1\r\n$CCCFG,TOA,1\r\n");
  }
  bench.medium->SetDelay(0, 1, 0.4);
  bench.Ask(0, 10.25, "$CCMUC,1,2,0123\r\n");
  bench.water->Advance(Ns(20.0));
  ASSERT_EQ(bench.log.sent.size(), 1u);
  EXPECT_NEAR(bench.log.sent[0].transmit * 1e-9, 11.0, 1e-6);
  // The time is set by command, the tick comes from outside.
  EXPECT_TRUE(Overheard(1, Seal("CATOA,221331.4000,14")));
  EXPECT_EQ(Names(1).substr(Names(1).find("RXP")), "RXP MUA TOA CST");
  // A ping follows. Its answer comes after the turnaround, as always.
  bench.Ask(0, 20.5, "$CCMPC,1,2\r\n");
  bench.water->Advance(Ns(30.0));
  EXPECT_TRUE(Overheard(0, Seal("CAMPR,2,1,0.4000")));
}

TEST_F(Cycles, WithoutAnAnswerAPingIsSilentAndTheModemFree) {
  bench.medium->SetLevel(0, 1, -100.0);
  bench.Ask(0, 10.0, "$CCMPC,1,2\r\n");
  bench.water->Advance(Ns(11.0));
  EXPECT_EQ(Names(0), "MPC TXP TXF");
  EXPECT_EQ(bench.micromodems[0]->state(), State::kIdle);
}

TEST_F(Cycles, AMiniPacketCarriesThirteenBits) {
  EXPECT_EQ(bench.Ask(0, 10.0, "$CCMUC,1,2,0123\r\n"), Seal("CAMUC,1,2,0123") + Seal("CATXP,2"));
  bench.water->Advance(Ns(20.0));
  EXPECT_EQ(Names(0), "MUC TXP TXF XST");
  EXPECT_NEAR(bench.When(1, Seal("CAMUA,1,2,0123")), 11.9, 1e-9);
  EXPECT_EQ(Names(1), "RXP MUA CST");
}

TEST_F(Cycles, FlexibleDataNeedsNoCycle) {
  EXPECT_EQ(bench.Ask(0, 10.0, "$CCTDP,2,1,1,0,48690A\r\n"),
            Seal("CATDP,0,1,2,1,1,0") + Seal("CATXP,3"));
  bench.water->Advance(Ns(20.0));
  EXPECT_TRUE(Overheard(1, Seal("CARDP,1,2,1,1,0,,1;3;48690A")));
  EXPECT_EQ(Names(1), "RXP RDP CST TXP TXF");
  EXPECT_TRUE(Overheard(0, Seal("CAACK,2,1,1,1")));
}

TEST_F(Cycles, FlexibleDataIsTextInBase64IfTheHostWantsIt) {
  bench.Ask(1, 5.0, "$CCCFG,recv.base64data,1\r\n");
  bench.Ask(0, 10.0, "$CCTDP,2,1,0,0,48690A00\r\n");
  bench.water->Advance(Ns(20.0));
  EXPECT_TRUE(Overheard(1, Seal("CARDP,1,2,1,0,0,,1;4;SGkKAA==")));
}

TEST_F(Cycles, TextPassesAsText) {
  bench.Ask(0, 10.0, "$CCCYC,0,1,0,1,0,1\r\n");
  bench.Ask(0, 10.0, "$CCTXA,1,0,0,hello, world\r\n");
  bench.water->Advance(Ns(20.0));
  EXPECT_TRUE(Overheard(1, Seal("CARXA,1,0,0,1,hello, world")));
}

TEST_F(Cycles, AFrameThatIsLostHasABadChecksum) {
  bench.Ask(0, 5.0, "$CCCYC,0,1,2,5,0,1\r\n");
  // It is acquired at -10 dB; half of the frames survive at 9 dB more.
  bench.medium->SetLevel(0, 1, -5.0);
  bench.Ask(0, 10.0, "$CCTXD,1,2,0,AA\r\n");
  bench.water->Advance(Ns(20.0));
  // The cycle comes first, because the header is intact. Error 3 is the one of the published
  // example.
  EXPECT_EQ(Names(1), "RXP CYC MSG CST");
  EXPECT_TRUE(Overheard(1, Seal("CAMSG,BAD_CRC,1")));
  EXPECT_TRUE(Overheard(1, ",5,1,2,3,3,1,1,"));
  EXPECT_TRUE(Overheard(1, "$CACST,6,1,"));
}

TEST_F(Cycles, TheStatisticsOfAReceptionHaveTheirFields) {
  bench.Ask(0, 10.0, "$CCTDP,2,5,0,0,AA\r\n");
  bench.water->Advance(Ns(20.0));
  const std::string& all = bench.hosts.all[1];
  const std::string cst = all.substr(all.find("$CACST"));
  // Version 6, good, time of arrival, ..., level 60, ..., rate 5, 1 to 2, FDP, one frame, ...
  EXPECT_EQ(cst.substr(0, cst.find('*')),
            "$CACST,6,0,20231114221331.000000,0,0,0,0,60,0,0,0,0,0,5,1,2,0,5,1,0,60,60,60,60,0,200,"
            "0.0,0,25000,5000");
}

TEST_F(Cycles, TheFirstGenerationsStatisticsHaveAsManyFieldsAsThePublishedExample) {
  const std::string example =
      "$CACST,1,153026.0000,0,4105,30,0318,0193,10,00,00,01,01,2,004,004,3,3,3,1,154,09,08,10,-6,"
      "000,0.0,4,25000,5000";
  ModemBench old(2);
  old.StartMicromodems("0.94.0.0");
  old.Ask(0, 10.0, "$CCMUC,1,2,1\r\n");
  old.water->Advance(Ns(20.0));
  const std::string& all = old.hosts.all[1];
  const std::string cst = all.substr(all.find("$CACST"));
  EXPECT_EQ(std::count(cst.begin(), cst.end(), ','),
            std::count(example.begin(), example.end(), ','));
}

TEST_F(Cycles, ARebootForgetsWhatWasUnderWay) {
  bench.Ask(0, 10.0, "$CCCYC,0,1,2,0,0,1\r\n");
  bench.Ask(0, 10.5, "$CCMSC,1,1,0\r\n");
  bench.water->Advance(Ns(12.0));
  EXPECT_EQ(bench.micromodems[0]->state(), State::kIdle);
  EXPECT_FALSE(Overheard(0, "$CADRQ"));
  EXPECT_TRUE(Overheard(0, Seal("CAREV,221331,INIT,2.0.35490")));
}

TEST_F(Cycles, ACycleWithoutItsFramesIsGivenUp) {
  bench.Ask(0, 10.0, "$CCCYC,0,1,2,0,0,1\r\n");
  bench.water->Advance(Ns(12.0));
  EXPECT_EQ(bench.micromodems[1]->state(), State::kHeardCycle);
  EXPECT_NE(bench.Ask(1, 12.0, "$CCMPC,2,1\r\n").find("BUSY"), std::string::npos);
  bench.water->Advance(Ns(30.0));
  EXPECT_EQ(bench.micromodems[1]->state(), State::kIdle);
  EXPECT_TRUE(Overheard(1, Seal("CAMSG,PACKET_TIMEOUT,0")));
}

TEST_F(Cycles, AnyOrderOfWordsLeavesTheModemIdle) {
  const std::string words[] = {"$CCCYC,0,1,2,0,1,1\r\n", "$CCTXD,1,2,1,AA\r\n",
                               "$CCMPC,1,2\r\n",         "$CCMUC,1,2,1FFF\r\n",
                               "$CCTXD,1,2,0,\r\n",      "$CCMSC,1,1,0\r\n",
                               "$CCTDP,2,3,1,0,BB\r\n",  "$CCCYC,0,2,1,1,1,2\r\n",
                               "$CCCFG,CST,0\r\n",       "$CCCFQ,ALL\r\n"};
  std::uint32_t seed = 1;
  double t_s = 10.0;
  for (int k = 0; k < 2000; ++k) {
    seed = seed * 1664525u + 1013904223u;
    bench.Say(static_cast<int>(seed >> 30 & 1), t_s, words[(seed >> 16) % 10]);
    t_s += 0.001 * static_cast<double>(seed >> 8 & 0xfff);
  }
  bench.water->Advance(Ns(t_s + 100.0));
  EXPECT_EQ(bench.micromodems[0]->state(), State::kIdle);
  EXPECT_EQ(bench.micromodems[1]->state(), State::kIdle);
  EXPECT_GT(bench.log.sent.size(), 100u);
}

}  // namespace
}  // namespace stg::acoustics

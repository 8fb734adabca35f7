#include <cstdio>

#include "modem_fixture.hpp"

/// What a single modem answers to its host.
namespace stg::acoustics {
namespace {

TEST(S2cModem, TheNetInterpreterAnswersPlainLines) {
  ModemBench bench(1);
  bench.StartS2c();
  EXPECT_EQ(bench.Ask(0, 0.1, "AT?MODE\n"), "NET\r\n");
  EXPECT_EQ(bench.Ask(0, 0.2, "AT?AL\r"), "1\r\n");
  EXPECT_EQ(bench.Ask(0, 0.3, "\nAT?S\n"), "INITIATION LISTEN\n\r\n");
  EXPECT_EQ(bench.Ask(0, 0.4, "+++AT?MODE\n"), "ERROR WRONG FORMAT\r\n");
  EXPECT_EQ(bench.Ask(0, 0.5, "hello\n"), "ERROR WRONG FORMAT\r\n");
}

TEST(S2cModem, AnswersOfManyLinesEndOnlyOnceWithACarriageReturn) {
  ModemBench bench(1);
  bench.StartS2c();
  const std::string paths = bench.Ask(0, 0.1, "AT?P\n");
  EXPECT_EQ(paths, "0 0\n0 0\n0 0\n0 0\n0 0\n0 0\n0 0\n0 0\n\r\n");
  const std::string all = bench.Ask(0, 0.2, "AT&V\n");
  EXPECT_EQ(all.find('\r'), all.size() - 2);
  EXPECT_EQ(all.rfind("Source Level: 0\n", 0), 0u);
}

/// The driver of dune reads the versions like this. It stops at a version that it cannot read.
TEST(S2cModem, VersionsAreReadAsDuneDoes) {
  ModemBench bench(1);
  bench.StartS2c();
  const std::string answer = bench.Ask(0, 0.1, "ATI1\n");
  char phy[64] = {}, mac[64] = {};
  ASSERT_EQ(std::sscanf(answer.c_str(), "phy:%*[^0]%63[^,], mac:%*[^v]v%63s", phy, mac), 2);
  EXPECT_STREQ(phy, "0.1");
  EXPECT_STREQ(mac, "1.9");
}

TEST(S2cModem, TheAtInterpreterCountsItsBytes) {
  ModemBench bench(1);
  bench.StartS2c({});
  EXPECT_EQ(bench.Ask(0, 0.1, "+++AT?MODE\n"), "+++AT?MODE:2:AT\r\n");
  EXPECT_EQ(bench.Ask(0, 0.2, "+++ATO\n"), "");
  EXPECT_EQ(bench.Ask(0, 0.3, "+++AT@CTRL\n"), "+++AT@CTRL:2:OK\r\n");
  EXPECT_EQ(bench.Ask(0, 0.4, "+++AT!L3\n"), "+++AT!L:5:[*]OK\r\n");
  EXPECT_EQ(bench.Ask(0, 0.5, "+++AT?L\n"), "+++AT?L:4:[*]3\r\n");
  EXPECT_EQ(bench.Ask(0, 0.6, "+++AT*SENDIM,5,1,noack,hello\n"),
            "+++AT*SENDIM:31:ERROR WRONG DESTINATION ADDRESS\r\n");
  EXPECT_EQ(bench.Ask(0, 0.7, "raw bytes\r\n"), "");
  EXPECT_EQ(bench.Ask(0, 0.8, "+++ATZ4\n"), "+++ATZ4:2:OK\r\n");
}

TEST(S2cModem, ManyCommandsInOneWriteAreAnsweredInTurn) {
  ModemBench bench(1);
  bench.StartS2c({});
  EXPECT_EQ(bench.Ask(0, 0.1, "+++ATZ4\r\n+++AT!AL5\r\n+++AT!L0\r\n+++AT?AL\r\n"),
            "+++ATZ4:2:OK\r\n+++AT!AL:5:[*]OK\r\n+++AT!L:2:OK\r\n+++AT?AL:4:[*]5\r\n");
}

TEST(S2cModem, CommandModeIsEnteredBySilenceOrByCommandAndLeftByAto) {
  ModemBench bench(1);
  bench.StartS2c({});
  EXPECT_EQ(bench.Ask(0, 0.5, "+++"), "");
  bench.water->Advance(Ns(2.0));
  EXPECT_EQ(bench.hosts.all[0], "OK\r\n");
  EXPECT_EQ(bench.Ask(0, 2.1, "AT?AL\n"), "1\r\n");
  EXPECT_EQ(bench.Ask(0, 2.2, "ATO\n"), "");
  EXPECT_EQ(bench.Ask(0, 2.3, "AT?AL\n"), "");  // this is data now
  EXPECT_EQ(bench.Ask(0, 2.4, "+++ATC\n"), "OK\r\n");
  EXPECT_EQ(bench.Ask(0, 2.5, "AT?AL\n"), "1\r\n");
}

TEST(S2cModem, WrongCommandsHaveTheirErrors) {
  ModemBench bench(2);
  bench.StartS2c();
  const auto expect = [&](const std::string& line, const std::string& error) {
    EXPECT_EQ(bench.Ask(0, 1.0, line + "\n"), "ERROR " + error + "\r\n") << line;
  };
  expect("AT?XYZ", "UNKNOWN COMMAND");
  expect("AT!XYZ1", "UNKNOWN COMMAND");
  expect("ATQ", "UNKNOWN COMMAND");
  expect("AT", "UNKNOWN COMMAND");
  expect("AT!L4", "OUT OF RANGE");
  expect("AT!AM7", "OUT OF RANGE");
  expect("AT!L", "WRONG FORMAT");
  expect("AT!L-1", "WRONG FORMAT");
  expect("AT?AL5", "WRONG FORMAT");
  expect("AT*SENDIM,0,2,ack,", "OUT OF RANGE");
  expect("AT*SENDIM,65,2,ack," + std::string(65, 'x'), "OUT OF RANGE");
  expect("AT*SENDIM,5,2,maybe,hello", "WRONG FORMAT");
  expect("AT*SENDIM,5,2,ack", "WRONG FORMAT");
  expect("AT*SENDIM,5,0,ack,hello", "WRONG DESTINATION ADDRESS");
  expect("AT*SENDIM,5,1,ack,hello", "WRONG DESTINATION ADDRESS");
  expect("AT*SENDIM,5,255,ack,hello", "WRONG DESTINATION ADDRESS");
  expect("AT*SENDIM,p300,5,2,ack,hello", "PROTOCOL ID");
  expect("AT*SEND,5,255,hello", "WRONG DESTINATION ADDRESS");
  expect("ATP", "NOT ACCEPTED");
  EXPECT_TRUE(bench.log.queued.empty());
}

TEST(S2cModem, AMessageThatNeverEndsIsGivenUp) {
  ModemBench bench(1);
  bench.StartS2c();
  bench.Say(0, 1.0, "AT*SENDIM,60,2,ack,half");
  bench.water->Advance(Ns(10.0));
  EXPECT_EQ(bench.hosts.all[0], "ERROR WRONG FORMAT\r\n");
  EXPECT_EQ(bench.Ask(0, 11.0, "AT?AL\n"), "1\r\n");
}

TEST(S2cModem, StoredSettingsSurviveARebootThatHangsUp) {
  ModemBench bench(1);
  bench.StartS2c();
  EXPECT_EQ(bench.Ask(0, 1.0, "AT!RI3\n"), "[*]OK\r\n");
  EXPECT_EQ(bench.Ask(0, 1.0, "AT&W\n"), "OK\r\n");
  EXPECT_EQ(bench.Ask(0, 1.0, "AT!RT900\n"), "[*]OK\r\n");
  EXPECT_EQ(bench.Ask(0, 1.0, "ATZ0\n"), "");
  EXPECT_EQ(bench.hosts.hung_up, std::vector<int>{0});
  bench.water->Connect(0, Ns(2.0));
  EXPECT_EQ(bench.Ask(0, 2.0, "AT?RI\n"), "3\r\n");
  EXPECT_EQ(bench.Ask(0, 2.0, "AT?RT\n"), "5000\r\n");
  EXPECT_EQ(bench.Ask(0, 3.5, "AT?CLOCK\n"), "2500000\r\n");  // time since the reboot
}

TEST(S2cModem, HalfALineDiesWithItsConnection) {
  ModemBench bench(1);
  bench.StartS2c();
  bench.Say(0, 1.0, "AT?A");
  bench.water->Disconnect(0, Ns(1.1));
  bench.water->Connect(0, Ns(1.2));
  EXPECT_EQ(bench.Ask(0, 1.3, "AT?L\n"), "0\r\n");
}

TEST(S2cModem, ASharedAddressIsAllowedAndToldOf) {
  ModemBench bench(2);
  bench.StartS2c();
  EXPECT_EQ(bench.Ask(0, 1.0, "AT!AL2\n"), "[*]OK\r\n");
  EXPECT_EQ(bench.hosts.shared, std::vector<int>{0});
}

TEST(S2cModem, NoiseAndDeafnessRefuseToSend) {
  ModemBench bench(2);
  bench.StartS2c();
  EXPECT_EQ(bench.Ask(0, 1.0, "ATS\n"), "INITIATION DEAF\r\n");
  EXPECT_EQ(bench.Ask(0, 1.0, "AT*SENDIM,2,2,ack,hi\n"), "ERROR NOT ACCEPTED\r\n");
  EXPECT_EQ(bench.Ask(0, 1.0, "ATA\n"), "INITIATION LISTEN\r\n");
  EXPECT_EQ(bench.Ask(0, 1.0, "AT*SENDIM,2,2,ack,hi\n"), "OK\r\n");
}

TEST(S2cModem, AWaterForModemsHasNoDelaysOfItsOwn) {
  ModemBench bench(1);
  bench.config.access = "csma";
  EXPECT_THROW(bench.Make(), UserError);
}

}  // namespace
}  // namespace stg::acoustics

#include "acoustic_channel/emulator/modem_file.hpp"
#include "acoustic_channel/micromodem/sentence.hpp"
#include "modem_fixture.hpp"

/// What a single Micromodem answers to its host.
namespace stg::acoustics {
namespace {

using micromodem::Seal;

TEST(Sentence, TheChecksumIsThatOfTheDocuments) {
  // Public documents have $CCCFG,SRC,1*31 and its answer $CACFG,SRC,1*33.
  EXPECT_EQ(Seal("CCCFG,SRC,1"), "$CCCFG,SRC,1*31\r\n");
  EXPECT_EQ(Seal("CACFG,SRC,1"), "$CACFG,SRC,1*33\r\n");
}

TEST(Sentence, TheSplitOfAStreamDoesNotMatter) {
  std::string stream =
      "\r\n$CCCLQ\n$CCCFQ,SRC*6F\r$CC_CFG\r\nnoise$CCCFG,SRC,1*31\r\n$CCCFG,SRC,1*32\r\n";
  stream[stream.find('_')] = '\0';
  const auto read = [&](std::size_t step) {
    micromodem::SentenceReader reader;
    std::string all;
    for (std::size_t at = 0; at < stream.size(); at += step) {
      const std::string part = stream.substr(at, step);
      reader.Feed({reinterpret_cast<const std::uint8_t*>(part.data()), part.size()});
      while (const auto sentence = reader.Next()) {
        all += sentence->error + "|" + micromodem::Join(sentence->fields) + "\n";
      }
    }
    return all;
  };
  const std::string whole = read(stream.size());
  EXPECT_NE(whole.find("|CCCFG,SRC,1\n"), std::string::npos);
  EXPECT_NE(whole.find("bad checksum|\n"), std::string::npos);
  for (const std::size_t step : {1u, 2u, 3u, 7u, 19u}) EXPECT_EQ(read(step), whole) << step;
}

TEST(Sentence, ALineWithoutEndIsDroppedAndTheNextOneRead) {
  micromodem::SentenceReader reader;
  const std::string text = "$" + std::string(20000, 'x');
  reader.Feed({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  ASSERT_EQ(reader.Next()->error, "line too long");
  EXPECT_FALSE(reader.Next());
  const std::string rest = "xx\r\n$CCCLQ\r\n";
  reader.Feed({reinterpret_cast<const std::uint8_t*>(rest.data()), rest.size()});
  EXPECT_EQ(reader.Next()->fields, std::vector<std::string>{"CCCLQ"});
}

TEST(Sentence, HexadecimalDigitsComeInPairs) {
  EXPECT_EQ(ToHex(std::string("\x00\xff", 2)), "00FF");
  EXPECT_EQ(FromHex("00fF"), std::string("\x00\xff", 2));
  EXPECT_FALSE(FromHex("0"));
  EXPECT_FALSE(FromHex("0g"));
}

TEST(Sentence, Base64IsThatOfTheStandard) {
  // RFC 4648, section 10
  const std::vector<std::pair<std::string, std::string>> known = {{"", ""},
                                                                  {"f", "Zg=="},
                                                                  {"fo", "Zm8="},
                                                                  {"foo", "Zm9v"},
                                                                  {"foob", "Zm9vYg=="},
                                                                  {"fooba", "Zm9vYmE="},
                                                                  {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, digits] : known) EXPECT_EQ(ToBase64(bytes), digits);
}

TEST(Micromodem, ItTellsItsRevisionWhenItHasBooted) {
  ModemBench bench(1);
  bench.StartMicromodems();
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCMSC,1,1,0\r\n"), Seal("CAMSC,1,1,0"));
  bench.water->Advance(Ns(6.0));
  EXPECT_NEAR(bench.When(0, Seal("CAREV,221324,INIT,2.0.35490")), 4.0, 1e-9);
  EXPECT_NEAR(bench.When(0, Seal("CAREV,221325,AUV,2.0.35490")), 5.0, 1e-9);
}

TEST(Micromodem, SettingsAreEchoedKeptAndListed) {
  ModemBench bench(2);
  bench.StartMicromodems();
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCCFG,SRC,5*35\r\n"), Seal("CACFG,SRC,5"));
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCCFQ,SRC\r\n"), Seal("CACFG,SRC,5"));
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCCFG,recv.odd,7\r\n"), Seal("CACFG,recv.odd,7"));
  const std::string all = bench.Ask(0, 3.0, "$CCCFQ,ALL\r\n");
  EXPECT_NE(all.find(Seal("CACFG,recv.odd,7")), std::string::npos);
  EXPECT_NE(all.find(Seal("CACFG,CST,1")), std::string::npos);
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCCFG,ALL,0\r\n"), Seal("CACFG,ALL,0"));
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCCFQ,SRC\r\n"), Seal("CACFG,SRC,1"));
}

TEST(Micromodem, TheClockIsTheHostsOnceItIsSet) {
  ModemBench bench(1);
  bench.StartMicromodems();
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCCLQ\r\n"), Seal("CACLK,2023,11,14,22,13,23"));
  EXPECT_EQ(bench.Ask(0, 4.0, "$CCCLK,2030,02,03,04,05,06\r\n"), Seal("CACLK,2030,02,03,04,05,06"));
  EXPECT_EQ(bench.Ask(0, 6.5, "$CCCLQ\r\n"), Seal("CACLK,2030,02,03,04,05,08"));
  EXPECT_EQ(bench.Ask(0, 7.0, "$CCTMS,2024-02-29T23:59:59Z,0\r\n"),
            Seal("CATMS,0,2024-02-29T23:59:59Z"));
  EXPECT_EQ(bench.Ask(0, 8.0, "$CCTMQ,0\r\n"), Seal("CATMQ,2024-03-01T00:00:00Z,USER_CMD,NONE"));
}

TEST(Micromodem, WithATickItsClockIsThatOfUtc) {
  ModemBench bench(1);
  bench.StartMicromodems();
  // The clock is set at the first full second after 7.4 s, whatever its fraction was before.
  EXPECT_EQ(bench.Ask(0, 7.4, "$CCTMS,2024-02-29T23:59:59Z,1\r\n"),
            Seal("CATMS,0,2024-02-29T23:59:59Z"));
  EXPECT_EQ(bench.Ask(0, 7.99, "$CCTMQ,0\r\n"), Seal("CATMQ,2024-02-29T23:59:58Z,USER_CMD,EXT"));
  EXPECT_EQ(bench.Ask(0, 8.01, "$CCTMQ,0\r\n"), Seal("CATMQ,2024-02-29T23:59:59Z,USER_CMD,EXT"));
  EXPECT_NE(bench.Ask(0, 9.0, "$CCTMS,2024-02-29T23:59:59Z,2\r\n").find("CAERR"),
            std::string::npos);
}

/// Some host software has no command for the tick, so a connected line must be enough.
TEST(Micromodem, WithALineThatTicksEveryCommandSetsTheClockAtTheNextTick) {
  for (const std::string firmware : {"2.0.35490", "0.94.0.0"}) {
    ModemBench bench(1);
    bench.pps = true;
    bench.StartMicromodems(firmware);
    const bool newer = firmware[0] == '2';
    const std::string set = newer ? "$CCTMS,2024-02-29T23:59:59Z,0" : "$CCCLK,2024,2,29,23,59,59";
    EXPECT_EQ(bench.Ask(0, 7.06, set + "\r\n"),
              Seal(newer ? "CATMS,0,2024-02-29T23:59:59Z" : "CACLK,2024,02,29,23,59,59"));
    EXPECT_EQ(bench.Ask(0, 7.99, "$CCCLQ\r\n"), Seal("CACLK,2024,02,29,23,59,58"));
    EXPECT_EQ(bench.Ask(0, 8.01, "$CCCLQ\r\n"), Seal("CACLK,2024,02,29,23,59,59"));
    bench.Ask(0, 8.2, "$CCMUC,1,0,0123\r\n");
    bench.water->Advance(Ns(10.0));
    // CAXST has the quality of the clock after the date and time of the start.
    const std::string clock =
        newer ? "CAXST,6,20240229,235959.2000,14," : "CAXST,20240229,235959.2000,3,";
    EXPECT_NE(bench.hosts.all[0].find(clock), std::string::npos) << bench.hosts.all[0];
  }
}

TEST(Micromodem, TheFirstGenerationKnowsLess) {
  ModemBench bench(1);
  bench.StartMicromodems("0.94.0.0");
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCTMQ,0\r\n"), Seal("CAERR,221323,NMEA,2,unknown sentence"));
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCTDP,2,1,0,0,AA\r\n"),
            Seal("CAERR,221323,NMEA,2,unknown sentence"));
}

TEST(Micromodem, WrongSentencesHaveTheirErrorsAndDoNothing) {
  ModemBench bench(2);
  bench.StartMicromodems();
  const auto fails = [&](const std::string& line) {
    const std::string answer = bench.Ask(0, 3.0, line + "\r\n");
    EXPECT_EQ(answer.rfind("$CAERR,221323,NMEA,", 0), 0u) << line << " -> " << answer;
    EXPECT_EQ(answer.find("\r\n"), answer.size() - 2) << "one answer: " << answer;
  };
  fails("$CCCFG,SRC,1*32");
  fails("hello");
  fails("$CCXYZ,1");
  fails("$GPRMC,1");
  fails("$CCCFG,SRC");
  fails("$CCCFG,SRC,128");
  fails("$CCCFQ,NONE");
  fails("$CCCLK,2024,13,01,00,00,00");
  fails("$CCCYC,0,1,2,7,0,1");
  fails("$CCCYC,0,1,2,1,0,4");  // three frames are allowed
  fails("$CCCYC,0,1,1,0,0,1");  // it is for itself
  fails("$CCCYC,0,1,2,0,0");
  fails("$CCMPC,1,1");
  fails("$CCMPC,1,0");
  fails("$CCMUC,1,2,2000");  // this has 14 bits
  fails("$CCMUC,1,2,");
  fails("$CCTDP,2,1,0,0,ABC");  // the number of digits is odd
  fails("$CCTDP,2,1,0,0,");
  EXPECT_TRUE(bench.log.queued.empty());
}

TEST(Micromodem, ADataRequestEndsWhenTheHostIsSilent) {
  ModemBench bench(2);
  bench.StartMicromodems();
  bench.Ask(0, 3.0, "$CCCFG,DTO,2\r\n");
  EXPECT_EQ(bench.Ask(0, 10.0, "$CCCYC,0,1,2,1,0,2\r\n"),
            Seal("CACYC,0,1,2,1,0,2") + Seal("CADRQ,221330,1,2,0,64,1"));
  EXPECT_EQ(bench.Ask(0, 11.0, "$CCCYC,0,1,2,1,0,2\r\n"),
            Seal("CAERR,221331,BUSY,6,busy with another command"));
  // The request stays open after a line that cannot be a frame.
  for (const char* frame : {"1,1,0,AA", "1,2,0,A", "1,2,2,AA", "1,2,0"}) {
    EXPECT_EQ(bench.Ask(0, 11.0, "$CCTXD," + std::string(frame) + "\r\n").rfind("$CAERR", 0), 0u);
  }
  bench.water->Advance(Ns(13.0));
  EXPECT_NEAR(bench.When(0, Seal("CAERR,221332,DATA_TIMEOUT,1")), 12.0, 1e-9);
  EXPECT_NE(bench.hosts.all[0].find("$CAXST,6,20231114,221332.0000,0,4,"), std::string::npos);
  EXPECT_EQ(bench.micromodems[0]->state(), micromodem::Micromodem::State::kIdle);
}

TEST(Micromodem, ItIsOfItsOwnFamilyOfProfiles) {
  EXPECT_EQ(WhyNot(Protocol::kMicromodem, "micromodem_psk_r1"), "");
  EXPECT_EQ(WhyNot(Protocol::kMicromodem, "micromodem_fsk_r0"), "");
  EXPECT_NE(WhyNot(Protocol::kMicromodem, "evologics_s2c"), "");
  EXPECT_NE(WhyNot(Protocol::kS2c, "micromodem_psk_r1"), "");
}

}  // namespace
}  // namespace stg::acoustics

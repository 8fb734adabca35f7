#include "acoustic_channel/micromodem/lbl.hpp"

#include "acoustic_channel/emulator/modem_file.hpp"
#include "acoustic_channel/micromodem/sentence.hpp"
#include "auv_common/error.hpp"
#include "modems/modem_fixture.hpp"
#include "scratch_file.hpp"

/// Ranging on a long baseline: $CCPDT and $CCPNT, their echoes $SNPDT and $SNPNT, and $SNTTA, as
/// the drivers of Goby and dune send and read them.
namespace stg::acoustics {
namespace {

using micromodem::Seal;
using micromodem::TransponderOptions;

TransponderOptions Remus(char letter, int turnaround_ms = 50) {
  TransponderOptions options;
  options.slot = letter - 'A';
  options.turnaround_ms = turnaround_ms;
  return options;
}

TransponderOptions Narrowband(int query_hz, int reply_hz, int turnaround_ms) {
  TransponderOptions options;
  options.query_hz = query_hz;
  options.reply_hz = reply_hz;
  options.turnaround_ms = turnaround_ms;
  return options;
}

/// Some modems, and behind them transponders.
struct LblBench : ModemBench {
  LblBench(int modem_count, const std::vector<TransponderOptions>& transponders)
      : ModemBench(modem_count + static_cast<int>(transponders.size())) {
    config.physical.modem.profile = "micromodem_psk_r1";
    Make();
    for (int i = 0; i < run.agents; ++i) {
      water->Attach(i, i < modem_count ? i + 1 : -1,
                    [&](ModemSurroundings* world) -> std::unique_ptr<ModemEngine> {
                      if (i >= modem_count) {
                        const auto k = static_cast<std::size_t>(i - modem_count);
                        return std::make_unique<micromodem::Transponder>(transponders[k], world);
                      }
                      micromodem::ModemOptions options;
                      options.address = i + 1;
                      auto modem = std::make_unique<micromodem::Micromodem>(options, world);
                      micromodems.push_back(modem.get());
                      return modem;
                    });
    }
    water->SetUtcStart(kUtcStart);
    Begin(modem_count);
    water->Advance(Ns(2.5));
    hosts.all.clear();
    hosts.said.clear();
  }
};

TEST(MicromodemLbl, TheTravelTimesOfARemusNetworkComeInOneSentence) {
  LblBench bench(1, {Remus('A'), Remus('C')});
  bench.medium->SetDelay(0, 1, 0.4);
  bench.medium->SetDelay(0, 2, 0.6667);
  EXPECT_EQ(bench.Ask(0, 10.0, "$CCPDT,1,3,0,0,2500,1,0,1,0\r\n"),
            Seal("SNPDT,1,3,0,0,2500,1,0,1,0"));
  EXPECT_EQ(bench.micromodems[0]->state(), micromodem::Micromodem::State::kRanging);
  bench.water->Advance(Ns(20.0));
  // Two ways, two sounds of 10 ms and the turnaround.
  EXPECT_NEAR(bench.When(0, Seal("SNTTA,0.4000,,0.6667,,221330.00")), 11.4034, 1e-9);
  EXPECT_EQ(bench.hosts.said.size(), 2u);
  EXPECT_EQ(bench.micromodems[0]->state(), micromodem::Micromodem::State::kIdle);
}

TEST(MicromodemLbl, WhoDoesNotAnswerInTimeLeavesAnEmptyField) {
  LblBench bench(1, {Remus('A'), Remus('B')});
  bench.medium->SetDelay(0, 1, 0.4);
  bench.medium->SetDelay(0, 2, 1.0);
  bench.Ask(0, 10.25, "$CCPDT,1,1,0,0,1500,1,1,1,1\r\n");
  EXPECT_EQ(bench.Ask(0, 10.5, "$CCMPC,1,2\r\n"),
            Seal("CAERR,221330,BUSY,6,busy with another command"));
  bench.water->Advance(Ns(20.0));
  EXPECT_NEAR(bench.When(0, Seal("SNTTA,0.4000,,,,221330.25")), 11.75, 1e-9);
  // What comes later than that does not count for the next ping.
  bench.Ask(0, 30.0, "$CCPDT,1,1,0,0,500,1,1,1,1\r\n");
  bench.water->Advance(Ns(40.0));
  EXPECT_NEAR(bench.When(0, Seal("SNTTA,,,,,221350.00")), 30.5, 1e-9);
}

TEST(MicromodemLbl, NarrowbandTranspondersAnswerTheirOwnFrequency) {
  LblBench bench(1, {Narrowband(26000, 25000, 20), Narrowband(26000, 24000, 20),
                     Narrowband(28000, 23000, 20)});
  bench.medium->SetDelay(0, 1, 0.2);
  bench.medium->SetDelay(0, 2, 0.3);
  bench.medium->SetDelay(0, 3, 0.1);
  EXPECT_EQ(bench.Ask(0, 3.0, "$CCCFG,TAT,20\r\n"), Seal("CACFG,TAT,20"));
  EXPECT_EQ(bench.Ask(0, 10.0, "$CCPNT,26000,5,5,2000,24000,23000,0,25000,1\r\n"),
            Seal("SNPNT,26000,5,5,2000,24000,23000,0,25000,1"));
  bench.water->Advance(Ns(20.0));
  EXPECT_NEAR(bench.When(0, Seal("SNTTA,0.3000,,,0.2000,221330.00")), 12.0, 1e-9);
  // With the wrong turnaround the ranges are wrong: by half of 30 ms.
  bench.Ask(0, 21.0, "$CCCFG,TAT,50\r\n");
  bench.Ask(0, 30.0, "$CCPNT,26000,5,5,2000,24000,0,0,25000,1\r\n");
  bench.water->Advance(Ns(40.0));
  EXPECT_NEAR(bench.When(0, Seal("SNTTA,0.2850,,,0.1850,221350.00")), 30.635, 1e-9);
}

/// Codes keep the pings of vehicles apart, and a modem that does not range hears none of them.
TEST(MicromodemLbl, TheRepliesToAnotherVehicleAreNotCounted) {
  LblBench bench(2, {Remus('A')});
  bench.medium->SetDelay(0, 2, 0.4);
  bench.medium->SetDelay(1, 2, 0.1);
  bench.medium->SetDelay(0, 1, 0.3);
  bench.Ask(1, 9.9, "$CCPDT,1,2,0,0,2500,1,0,0,0\r\n");
  bench.water->Advance(Ns(20.0));
  EXPECT_TRUE(bench.hosts.all[0].empty()) << bench.hosts.all[0];
  bench.Ask(1, 29.9, "$CCPDT,1,2,0,0,2500,1,0,0,0\r\n");
  bench.Ask(0, 30.0, "$CCPDT,1,1,0,0,2500,1,0,0,0\r\n");
  bench.water->Advance(Ns(40.0));
  bench.When(0, Seal("SNTTA,0.4000,,,,221350.00"));
  bench.When(1, Seal("SNTTA,0.1000,,,,221349.90"));
}

TEST(MicromodemLbl, WrongFieldsHaveTheirErrorsAndDoNothing) {
  LblBench bench(1, {Remus('A')});
  for (const char* line :
       {"CCPDT", "CCPDT,2,1,0,0,2500,1,1,1,1", "CCPDT,1,0,0,0,2500,1,1,1,1",
        "CCPDT,1,5,0,0,2500,1,1,1,1", "CCPDT,1,1,1,0,2500,1,1,1,1", "CCPDT,1,1,0,0,0,1,1,1,1",
        "CCPDT,1,1,0,0,2500,2,1,1,1", "CCPDT,1,1,0,0,2500,1,1,1", "CCPNT,0,5,5,2000,1,2,3,4,1",
        "CCPNT,26000,0,5,2000,1,2,3,4,1", "CCPNT,26000,51,5,2000,1,2,3,4,1",
        "CCPNT,26000,5,5,60001,1,2,3,4,1", "CCPNT,26000,5,5,2000,1,2,3,4,0",
        "CCPNT,26000,5,5,2000,1,2,3,-4,1"}) {
    const std::string name = std::string(line).substr(0, 5);
    EXPECT_EQ(bench.Ask(0, 3.0, "$" + std::string(line) + "\r\n"),
              Seal("CAERR,221323,NMEA,3," + name + " with invalid fields"))
        << line;
  }
  EXPECT_TRUE(bench.log.queued.empty());
}

TEST(MicromodemLbl, ARebootEndsTheRanging) {
  LblBench bench(1, {Remus('A')});
  bench.Ask(0, 10.0, "$CCPDT,1,1,0,0,2500,1,0,0,0\r\n");
  bench.Ask(0, 10.1, "$CCRST,0\r\n");
  bench.water->Advance(Ns(20.0));
  EXPECT_EQ(bench.hosts.all[0].find("SNTTA"), std::string::npos);
  EXPECT_EQ(bench.micromodems[0]->state(), micromodem::Micromodem::State::kIdle);
}

TEST(MicromodemLbl, TheFileSaysWhatATransponderIs) {
  const auto load = [](const std::string& keys, const std::string& profile = "micromodem_psk_r1") {
    const ScratchFile file("vehicles:\n  - {name: a, position_m: [0, 0, -20], " + keys +
                           "}\nchannel:\n  model: physical\n  access: aloha\n  physical:\n"
                           "    modem: {profile: " +
                           profile + ", queue: fifo}\n");
    return LoadModemFile(file.path()).vehicles[0];
  };
  const ModemVehicle remus = load("transponder: {letter: C}");
  ASSERT_TRUE(remus.transponder);
  EXPECT_FALSE(remus.ordinary());
  EXPECT_EQ(remus.transponder->slot, 2);
  EXPECT_EQ(remus.transponder->turnaround_ms, 50);
  const ModemVehicle narrow =
      load("transponder: {query_hz: 26000, reply_hz: 25000, turnaround_ms: 20}");
  EXPECT_EQ(narrow.transponder->slot, -1);
  EXPECT_EQ(narrow.transponder->reply_hz, 25000);
  for (const char* keys :
       {"transponder: {}", "transponder: {letter: E}", "transponder: {query_hz: 26000}",
        "transponder: {letter: A, reply_hz: 25000, query_hz: 26000}", "transponder: A",
        "transponder: {letter: A}, modem: {protocol: micromodem, tcp: 0}"}) {
    EXPECT_THROW(load(keys), UserError) << keys;
  }
  EXPECT_THROW(load("transponder: {letter: A}", "evologics_s2c"), UserError);
}

}  // namespace
}  // namespace stg::acoustics

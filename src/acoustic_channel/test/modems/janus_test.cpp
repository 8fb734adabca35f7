#include "acoustic_channel/engine/text.hpp"
#include "modem_fixture.hpp"

/// JANUS: the bits are those that janus-tx 3.0.5 of the public janus-c writes with the same
/// options. Two modems exchange packets over 1500 m.
namespace stg::acoustics {
namespace {

std::string HexOf(const janus::Packet& p) {
  const auto bytes = janus::Encode(p);
  return ToHex(std::string(bytes.begin(), bytes.end()));
}

TEST(JanusPacket, BitsAreThoseOfThePublicTool) {
  janus::Packet p;
  EXPECT_EQ(HexOf(p), "3210000000000055");  // --packet-class-id 16 --packet-app-type 0
  p.class_id = 21;
  p.app_type = 5;
  p.app_data = 0x123456789;
  EXPECT_EQ(HexOf(p), "321515234567899D");
  p.app_data = 0x1234567;
  p.mobility = p.forward = true;
  p.tx_rx = false;
  p.schedule = janus::Packet::Schedule::kReservation;
  p.schedule_index = janus::ScheduleIndex(p.schedule, 600.0).value();
  EXPECT_EQ(HexOf(p), "3D1515FD234567D5");
  p.mobility = p.forward = false;
  p.tx_rx = true;
  p.schedule = janus::Packet::Schedule::kRepeat;
  p.schedule_index = janus::ScheduleIndex(p.schedule, 0.08819237).value();
  EXPECT_EQ(HexOf(p), "36151619234567C3");
}

TEST(JanusPacket, WhatIsWrittenIsRead) {
  for (std::uint64_t k = 0; k < 4096; ++k) {
    janus::Packet p;
    p.mobility = k & 1;
    p.forward = k & 2;
    p.tx_rx = k & 4;
    p.class_id = static_cast<int>(k * 37 % 256);
    p.app_type = static_cast<int>(k * 11 % 64);
    p.schedule = static_cast<janus::Packet::Schedule>(k % 3);
    p.schedule_index = p.schedule == janus::Packet::Schedule::kNone ? 0 : static_cast<int>(k % 128);
    p.app_data = k * 0x9e3779b97f4a7c15u >> (64 - p.app_data_bits());
    auto bytes = janus::Encode(p);
    const auto read = janus::Decode(bytes);
    ASSERT_TRUE(read);
    EXPECT_EQ(janus::Encode(*read), bytes);
    EXPECT_EQ(read->app_data, p.app_data);
    // The checksum detects every single wrong bit.
    bytes[k % 8] = static_cast<std::uint8_t>(bytes[k % 8] ^ 1u << (k / 8 % 8));
    EXPECT_FALSE(janus::Decode(bytes));
  }
}

TEST(JanusPacket, ChecksumsHaveTheirPublishedCheckValues) {
  const std::string digits = "123456789";
  EXPECT_EQ(janus::Crc8(reinterpret_cast<const std::uint8_t*>(digits.data()), 9), 0xf4);
  EXPECT_EQ(janus::Crc16(digits), 0xbb3d);  // CRC-16/ARC
}

TEST(JanusPacket, EachTimeOfTheSeriesIsItsOwnNearest) {
  for (const auto schedule :
       {janus::Packet::Schedule::kReservation, janus::Packet::Schedule::kRepeat}) {
    for (int k = 0; k < 128; ++k) {
      EXPECT_EQ(janus::ScheduleIndex(schedule, janus::ScheduleS(schedule, k)), k);
    }
  }
  EXPECT_FALSE(janus::ScheduleIndex(janus::Packet::Schedule::kReservation, 700.0));
}

struct JanusModems : testing::Test {
  JanusModems() : bench(2) { bench.StartJanus(); }
  ModemBench bench;
};

TEST_F(JanusModems, ABaselinePacketTakesElevenTenthsOfASecond) {
  EXPECT_EQ(bench.Ask(0, 10.0, "tx class=21 type=5 data=0x123456789\n"),
            "ok packet=321515234567899D\r\nsending airtime=1.100\r\n");
  EXPECT_EQ(bench.Ask(0, 10.5, "tx\n"), "error busy\r\n");
  bench.water->Advance(Ns(15.0));
  EXPECT_NEAR(bench.When(0, "sent\r\n"), 11.1, 1e-9);
  EXPECT_NEAR(bench.When(1, "detected after=11.000000\r\n"), 11.0, 1e-9);
  EXPECT_NEAR(bench.When(1,
                         "rx class=21 type=5 mobility=0 tx-rx=1 forward=0 data=0x123456789 "
                         "level=60.0 noise=0.0 snr=60.0 speed=0.000 after=11.000000 "
                         "packet=321515234567899D\r\n"),
              12.1, 1e-9);
}

TEST_F(JanusModems, CargoFollowsAsTheToolPadsIt) {
  // Made with janus-tx --packet-app-fields
  // "StationIdentifier=3,ParameterSetIdentifier=5,Payload=hello"
  EXPECT_EQ(bench.Ask(0, 10.0, "tx station=3 set=5 text=hello\n"),
            "ok packet=321000000C014461\r\nsending airtime=2.000\r\n");
  bench.water->Advance(Ns(20.0));
  EXPECT_NE(bench.hosts.all[1].find(" station=3 set=5 cargo=68656C6C6F000000 "), std::string::npos);
}

TEST_F(JanusModems, AddressedCargoHasAChecksum) {
  EXPECT_EQ(bench.Ask(0, 10.0, "tx type=1 station=3 destination=9 ack=1 cargo=68656c6c6f\n"),
            "ok packet=321004000C2607E5\r\nsending airtime=1.900\r\n");
  bench.water->Advance(Ns(20.0));
  EXPECT_NE(bench.hosts.all[1].find(" station=3 destination=9 ack=1 cargo=68656C6C6F crc=ok "),
            std::string::npos);
  // A host may also give the bits of a packet.
  bench.Ask(0, 30.0, "tx packet=321004000C2607E5 cargo=68656c6c6f0000\n");
  bench.water->Advance(Ns(40.0));
  EXPECT_NE(bench.hosts.all[1].find(" cargo=68656C6C6F crc=bad "), std::string::npos);
}

TEST_F(JanusModems, WhatDoesNotFitIsRefusedWithItsReason) {
  const auto refused = [&](const std::string& line, const std::string& why) {
    EXPECT_EQ(bench.Ask(0, 1.0, line + "\n"), "error " + why + "\r\n") << line;
  };
  refused("sing", "unknown command");
  refused("tx colour=red", "unknown word");
  refused("tx class", "a word without =");
  refused("tx class=16 class=16", "class twice");
  refused("tx class=256", "class must be 0 to 255");
  refused("tx type=64", "type must be 0 to 63");
  refused("tx class=21 data=0x400000000", "data must fit into 34 bits");
  refused("tx class=21 reserve=1 data=0x4000000", "data must fit into 26 bits");
  refused("tx reserve=900", "the standard has no such time of a schedule");
  refused("tx reserve=0.5 text=hello", "the reservation does not cover the cargo");
  refused("tx class=21 text=hello", "cargo needs class 16 and type 0 or 1, which state its length");
  refused("tx cargo=123", "cargo must be pairs of hexadecimal digits");
  refused("tx class=21 station=3", "station does not belong to this class and type");
  refused("tx type=1 set=3", "set does not belong to this class and type");
  refused("tx data=0 station=3", "station is part of data: give one of the two");
  refused("tx packet=3210000000000056", "packet with a wrong checksum or version");
  refused("tx packet=321000000C014461", "packet states another length of cargo");
  refused("status now=1", "words behind a command that takes none");
  refused(std::string(5000, 'x'), "line too long");
  EXPECT_EQ(bench.Ask(0, 1.0, "status\r\nversion\r\n"), "status idle\r\nversion 3\r\n");
  EXPECT_TRUE(bench.log.sent.empty());
}

TEST_F(JanusModems, WhatIsLostAfterItsBeginIsTold) {
  bench.medium->SetLevel(0, 1, -7.9);
  for (int k = 0; k < 20; ++k) bench.Ask(0, 10.0 + 10.0 * k, "tx\n");
  bench.water->Advance(Ns(300.0));
  EXPECT_NE(bench.hosts.all[1].find("lost level=-7.9"), std::string::npos);
}

TEST(JanusForeign, AnOrdinaryVehicleHearsTheBits) {
  ModemBench bench(2);
  bench.config.physical.modem.profile = "janus";
  bench.Make();
  bench.water->Attach(0, 1, [](ModemSurroundings* world) {
    return std::make_unique<janus::JanusModem>(janus::ModemOptions(), world);
  });
  bench.Begin(1);
  bench.Ask(0, 1.0, "tx class=21 type=5 data=0x123456789\n");
  bench.water->Advance(Ns(9.0));
  std::vector<Reception> received;
  bench.water->network().Take(1, Ns(9.0), &received);
  ASSERT_EQ(received.size(), 1u);
  const std::string bytes(received[0].payload.data, received[0].payload.data + 8);
  EXPECT_EQ(ToHex(bytes), "321515234567899D");
}

}  // namespace
}  // namespace stg::acoustics

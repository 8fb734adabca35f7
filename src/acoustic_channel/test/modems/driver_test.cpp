#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/driver/micromodem_driver.hpp"
#include "acoustic_channel/driver/modem_channel.hpp"
#include "acoustic_channel/driver/s2c_driver.hpp"
#include "acoustic_channel/emulator/modem_server.hpp"
#include "auv_common/error.hpp"
#include "modem_fixture.hpp"
#include "scratch_file.hpp"

/// Drivers with emulated modems: over byte pipes in simulated time, and over TCP.
namespace stg::acoustics {
namespace {

/// What one driver tells. Its bytes go to the modem of one node.
struct Wire : DriverWorld {
  void Write(const std::string& bytes) override { to_modem += bytes; }
  void HangUp() override { ++hung_up; }
  void OnReception(const DriverReception& r) override { received.push_back(r); }
  void OnQueued(std::uint32_t tag) override { queued.push_back(tag); }
  void OnSent(std::uint32_t tag, TimeNs t) override { sent.emplace_back(tag, Seconds(t)); }
  void OnSendEnd(std::uint32_t tag, double airtime_s) override {
    ended.emplace_back(tag, airtime_s);
  }
  void OnDropped(std::uint32_t tag) override { dropped.push_back(tag); }
  void OnRefused(std::uint32_t tag, const std::string& why) override {
    refused.emplace_back(tag, why);
  }
  void OnRange(int address, double s) override { ranges.emplace_back(address, s); }

  std::string to_modem;
  int hung_up = 0;
  std::vector<DriverReception> received;
  std::vector<std::uint32_t> queued, dropped;
  std::vector<std::pair<std::uint32_t, double>> sent, ended;
  std::vector<std::pair<std::uint32_t, std::string>> refused;
  std::vector<std::pair<int, double>> ranges;
};

/// Two drivers with their modems, and the time.
struct Pair {
  explicit Pair(const std::string& protocol, const std::string& firmware = "2.0.35490") : bench(2) {
    if (protocol == "s2c") {
      bench.StartS2c();
    } else {
      bench.StartMicromodems(firmware);
    }
    for (int i = 0; i < 2; ++i) {
      DriverOptions options;
      options.address = i + 1;
      drivers.push_back(MakeModemDriver(protocol, options, &wires[i]));
    }
    seen = {{0, bench.hosts.all[0].size()}, {1, bench.hosts.all[1].size()}};
    t = std::max(bench.water->now(), Ns(3.0));
    for (const auto& driver : drivers) driver->Connect(t);
    Run(0.5);
  }
  /// Time passes in steps of 1 ms. Bytes take no time.
  void Run(double seconds) {
    const TimeNs end = t + Ns(seconds);
    for (; t < end; t += 1'000'000) {
      bench.water->Advance(t);
      for (bool more = true; more;) {
        more = false;
        for (int i = 0; i < 2; ++i) {
          const std::string out = std::exchange(wires[i].to_modem, "");
          if (!out.empty() && !deaf) bench.Say(i, Seconds(t), out);
          const std::string in = bench.hosts.all[i].substr(seen[i]);
          seen[i] = bench.hosts.all[i].size();
          if (!in.empty()) {
            drivers[i]->Read(t, {reinterpret_cast<const std::uint8_t*>(in.data()), in.size()});
          }
          if (drivers[i]->next() <= t) drivers[i]->Tick(t);
          more = more || !in.empty() || !wires[i].to_modem.empty();
        }
      }
    }
  }
  void Send(int node, std::uint32_t tag, int destination, const std::string& payload) {
    drivers[static_cast<std::size_t>(node)]->Send({tag, destination, payload}, t);
  }
  ModemBench bench;
  Wire wires[2];
  std::vector<std::unique_ptr<ModemDriver>> drivers;
  std::map<int, std::size_t> seen;
  TimeNs t = 0;
  bool deaf = false;
};

std::string AnyBytes() {
  std::string bytes;
  for (int k = 0; k < 32; ++k) bytes += static_cast<char>(k * 9);
  return bytes.replace(2, 4, "\r\n,$");
}

struct Drivers : testing::TestWithParam<const char*> {};

TEST_P(Drivers, APacketArrivesAsItWasSent) {
  Pair pair(GetParam());
  ASSERT_TRUE(pair.drivers[0]->ready());
  pair.Send(0, 7, kToAll, AnyBytes());
  pair.Run(10.0);
  EXPECT_EQ(pair.wires[0].queued, std::vector<std::uint32_t>{7});
  ASSERT_EQ(pair.wires[0].sent.size(), 1u);
  ASSERT_EQ(pair.wires[0].ended.size(), 1u);
  EXPECT_NEAR(pair.wires[0].ended[0].second,
              Seconds(pair.bench.log.sent[0].transmit_end - pair.bench.log.sent[0].transmit), 2e-3);
  ASSERT_EQ(pair.wires[1].received.size(), 1u);
  const DriverReception& r = pair.wires[1].received[0];
  EXPECT_EQ(r.source, 1);
  EXPECT_EQ(r.destination, kToAll);
  EXPECT_EQ(r.payload, AnyBytes());
  EXPECT_NEAR(r.received_level_db, 60.0, 0.5);
  // The end of the sound arrives one second after it has left.
  EXPECT_NEAR(Seconds(r.arrival), Seconds(pair.bench.log.sent[0].transmit_end) + 1.0, 2e-3);
}

TEST_P(Drivers, OfThoseThatWaitTheNewestStays) {
  Pair pair(GetParam());
  for (std::uint32_t tag = 1; tag <= 4; ++tag) pair.Send(0, tag, 2, std::string(8, 'a'));
  pair.Run(15.0);
  EXPECT_EQ(pair.wires[0].dropped, (std::vector<std::uint32_t>{2, 3}));
  EXPECT_EQ(pair.wires[0].queued, (std::vector<std::uint32_t>{1, 4}));
  ASSERT_EQ(pair.wires[1].received.size(), 2u);
  EXPECT_EQ(pair.wires[1].received[0].destination, 2);
}

TEST_P(Drivers, APingMeasuresTheOneWayTime) {
  Pair pair(GetParam());
  pair.drivers[0]->Ping(2, pair.t);
  pair.Run(10.0);
  ASSERT_EQ(pair.wires[0].ranges.size(), 1u);
  EXPECT_EQ(pair.wires[0].ranges[0].first, 2);
  EXPECT_NEAR(pair.wires[0].ranges[0].second, 1.0, 1e-4);
  EXPECT_TRUE(pair.wires[1].received.empty());  // the driver delivers no packet
  pair.Send(0, 1, kToAll, "next");
  pair.Run(10.0);
  EXPECT_EQ(pair.wires[1].received.size(), 1u);
}

TEST_P(Drivers, APingWithoutAnswerEnds) {
  Pair pair(GetParam());
  pair.bench.medium->SetLevel(0, 1, -100.0);
  pair.drivers[0]->Ping(2, pair.t);
  pair.Run(25.0);
  ASSERT_EQ(pair.wires[0].ranges.size(), 1u);
  EXPECT_LT(pair.wires[0].ranges[0].second, 0.0);
}

TEST_P(Drivers, ASilentModemIsAskedThreeTimesAndThenHungUp) {
  Pair pair(GetParam());
  pair.deaf = true;
  pair.Send(0, 1, kToAll, "hello");
  pair.Run(2.9);
  EXPECT_EQ(pair.wires[0].hung_up, 0);
  pair.Run(0.2);
  EXPECT_EQ(pair.wires[0].hung_up, 1);
  EXPECT_FALSE(pair.drivers[0]->ready());
  // After a new connection, the driver sets the modem up again and sends the newest packet.
  pair.drivers[0]->Disconnect(pair.t);
  pair.deaf = false;
  pair.drivers[0]->Connect(pair.t);
  pair.Send(0, 2, kToAll, "again");
  pair.Run(10.0);
  ASSERT_EQ(pair.wires[1].received.size(), 1u);
  EXPECT_EQ(pair.wires[1].received[0].payload, "again");
  EXPECT_EQ(pair.wires[0].dropped, std::vector<std::uint32_t>{1});
}

INSTANTIATE_TEST_SUITE_P(Protocols, Drivers, testing::Values("s2c", "micromodem"),
                         [](const auto& info) { return std::string(info.param); });

/// What the driver makes of one notification of its modem.
Wire AfterLine(const std::string& content) {
  Wire wire;
  s2c::S2cDriver driver({}, &wire);
  const std::string line = content + "\r\n";
  driver.Read(Ns(1.0), {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  EXPECT_EQ(driver.counts().lost, wire.received.empty() ? 1u : 0u);
  return wire;
}

// A serial line may damage a digit. Such a number must not get into a message of ROS.
TEST(S2cDriver, AReceptionWithADamagedNumberCountsAsLost) {
  const Wire good = AfterLine("RECVIM,5,1,2,noack,206500,-58,457,-0.25,hello");
  ASSERT_EQ(good.received.size(), 1u);
  EXPECT_EQ(good.received[0].source, 1);
  EXPECT_DOUBLE_EQ(good.received[0].airtime_s, 0.2065);
  EXPECT_DOUBLE_EQ(good.received[0].doppler_mps, -0.25);
  for (const char* damaged :
       {"RECVIM,5,231114221331.0,2,noack,206500,-58,457,0.0,hello",
        "RECVIM,5,1,x,noack,206500,-58,457,0.0,hello", "RECVIM,5,1,2,noack,nan,-58,457,0.0,hello",
        "RECVIM,5,1,2,noack,206500,inf,457,0.0,hello",
        "RECVIM,5,1,2,noack,206500,-58,457,1e999,hello"}) {
    EXPECT_TRUE(AfterLine(damaged).received.empty()) << damaged;
  }
}

TEST(Text, ARealNumberIsTheWholeTextAndInTheRange) {
  EXPECT_EQ(RealIn("-0.5", -1.0, 1.0), -0.5);
  EXPECT_EQ(RealIn("+0.5", -1.0, 1.0), 0.5);
  EXPECT_EQ(RealIn("1e-1", -1.0, 1.0), 0.1);
  for (const char* text :
       {"", "+", "+-1", "nan", "inf", "-inf", "1e999", "0.5 ", " 0.5", "0.5x", "2"}) {
    EXPECT_EQ(RealIn(text, -1.0, 1.0), std::nullopt) << text;
  }
}

TEST(S2cDriver, WhatIsTooLongIsRefused) {
  Pair pair("s2c");
  pair.Send(0, 9, kToAll, std::string(65, 'x'));
  pair.Run(1.0);
  ASSERT_EQ(pair.wires[0].refused.size(), 1u);
  EXPECT_EQ(pair.wires[0].refused[0].second, "ERROR OUT OF RANGE");
}

TEST(MicromodemDriver, AModemOfTheFirstGenerationGetsCycles) {
  Pair pair("micromodem", "0.94.0.0");
  pair.Send(0, 3, kToAll, AnyBytes());
  pair.Run(15.0);
  ASSERT_EQ(pair.wires[1].received.size(), 1u);
  EXPECT_EQ(pair.wires[1].received[0].payload, AnyBytes());
  ASSERT_EQ(pair.wires[0].ended.size(), 1u);
  EXPECT_NEAR(pair.wires[0].ended[0].second, 3.2, 2e-3);
}

/// No receiver knows which packets its modem did not hear. It must not count a packet as lost
/// because others heard it.
TEST(ModemChannel, EveryReceiverCountsThePacketsThatItHears) {
  std::string text = "vehicles:\n";
  for (const char* place : {"0.0", "30.0", "60.0"}) {
    text += std::string("  - {name: v") + place[0] + ", position_m: [" + place +
            ", 0.0, -20.0], modem: {tcp: 0, interpreter: net}}\n";
  }
  text +=
      "channel:\n  model: physical\n  access: aloha\n  physical:\n    modem:\n"
      "      profile: evologics_s2c\n      queue: fifo\n";
  const ScratchFile file(text);
  const ModemFile modems = LoadModemFile(file.path());
  ModemServer server(modems, "");
  ModemChannelConfig config;
  for (int i = 0; i < 3; ++i) {
    const std::string name = server.port(i)->name();
    config.ports.push_back("tcp://127.0.0.1" + name.substr(name.rfind(':')));
  }
  ModemChannel channel(modems.network.channel, modems.network.run, config);
  channel.Reset(1, 0);
  const TimeNs start = SteadyNow();
  const auto wait = [&](const auto& until) {
    while (!until() && SteadyNow() < start + 30 * kSecond) {
      server.Serve(server.Now() + 2'000'000);
    }
  };
  wait([&] {
    return channel.health(0).ready && channel.health(1).ready && channel.health(2).ready;
  });
  std::vector<std::uint32_t> heard[3];
  const std::uint8_t byte = 7;
  for (std::uint32_t k = 0; k < 3; ++k) {
    Transmission packet;
    packet.source = 0;
    packet.destination = kToAll;
    packet.tag = k;
    packet.payload = {&byte, 1};
    channel.Step(SteadyNow() - start, k, {}, {}, {packet});
    wait([&] {
      for (const int node : {1, 2}) {
        std::vector<Reception> out;
        channel.Deliver(node, 0, &out);
        for (const Reception& r : out) heard[node].push_back(r.sequence);
      }
      return heard[1].size() > k && heard[2].size() > k;
    });
  }
  for (const int node : {1, 2}) EXPECT_EQ(heard[node], (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(DriverOptions, AnUnknownProtocolIsRefused) {
  Wire wire;
  EXPECT_THROW(MakeModemDriver("janus", {}, &wire), UserError);
}

TEST(AnswerReader, TheSplitOfAStreamDoesNotMatter) {
  // An R 18/34 prints this: lengths, addresses, duration, level, integrity, velocity, payload.
  const std::string stream =
      "OK\r\nRECVIM,5,1,2,noack,206500,-42,160,0.0310,a\r\n,b\r\nSENDEND,2,im,1,2\r\n"
      "RECVPBM,2,1,2,206500,-42,160,0.0310,\r\n\r\n[*]OK\r\n";
  const auto read = [&](std::size_t step) {
    s2c::AnswerReader reader;
    std::string all;
    for (std::size_t at = 0; at < stream.size(); at += step) {
      const std::string part = stream.substr(at, step);
      reader.Feed({reinterpret_cast<const std::uint8_t*>(part.data()), part.size()});
      while (const auto line = reader.Next()) all += line->name() + "<" + line->payload + ">";
    }
    return all;
  };
  EXPECT_EQ(read(1000), "OK<>RECVIM<a\r\n,b>SENDEND<>RECVPBM<\r\n>[*]OK<>");
  for (const std::size_t step : {1u, 2u, 5u, 13u}) EXPECT_EQ(read(step), read(1000)) << step;
}

}  // namespace
}  // namespace stg::acoustics
